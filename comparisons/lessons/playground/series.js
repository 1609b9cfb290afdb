"use strict";
// Taylor series of the motion over one step, coefficient by coefficient: analytic/kernel/steps.py in JavaScript.
// Row 0 of each is given, the rest is filled up to `order`. S and C are sin and cos of s gamma - phi.
const Series = (() => {
  const row = () => new Float64Array(Polynomial.MAX_ORDER + 2);
  const P = { phi: row(), w: row(), S: row(), C: row(), x: row(), v: row(), q: row(), F: row(), absolute: row(),
    ground: row(), event: row() };
  const NEGLIGIBLE = 1e-200, MOST_SHRINK = 1e-3;

  // Highest coefficient of a_g that is not zero, or -1. `a0`, `slope`: between samples; else `a0` sin(u + frequency t).
  function groundSeries(kind, a0, slope, frequency, u, order) {
    const A = P.ground;
    if (kind === Scene.QUIET) return -1;
    if (kind === Scene.SAMPLED) {
      A[0] = a0;
      A[1] = slope;
      return 1;
    }
    A[0] = a0 * Math.sin(u);
    A[1] = a0 * frequency * Math.cos(u);
    for (let k = 0; k < order - 1; k++) A[k + 2] = (-frequency * frequency * A[k]) / ((k + 1) * (k + 2));
    return order;
  }

  // Rocking on rigid ground, eq. (4) with x = 0: phi'' = -omega_r^2 (S + a_g/g C).
  function rigid(par, order, highest) {
    const { phi, w, S, C, ground: A } = P;
    for (let k = 0; k < order; k++) {
      if (k > 0) {
        let sine = 0, cosine = 0;
        for (let j = 0; j < k; j++) {
          sine += w[j] * C[k - 1 - j];
          cosine += w[j] * S[k - 1 - j];
        }
        S[k] = -sine / k;
        C[k] = cosine / k;
      }
      let push = 0;
      for (let j = Math.min(k, highest); j >= 0; j--) push += A[j] * C[k - j];
      w[k + 1] = (-par.p2 * (S[k] + push / par.g)) / (k + 1);
      phi[k + 1] = w[k] / (k + 1);
    }
  }

  // Force of the bearings of order k > 0: with y = D_c + s (x - x_c), y q' = (1 - alpha) y' q.
  function bearingTerm(par, k, { over, power, slope }) {
    const { x, v, q, F } = P;
    let speed = 0, travel = 0;
    for (let j = 0; j < k; j++) {
      speed += v[j] * q[k - 1 - j];
      travel += x[j + 1] * q[k - 1 - j];
    }
    q[k] = over * ((power * speed) / k - travel);
    F[k] = par.count * (par.kb * x[k] + slope * q[k]);
  }

  // Full contact on the base, eq. (2): (m + m_b)(a_g + x'') + n_d f = 0.
  function contact(par, order, highest, factors) {
    const { x, v, F, absolute, ground: A } = P;
    for (let k = 0; k <= order; k++) {
      if (k > 0) bearingTerm(par, k, factors);
      absolute[k] = -F[k] / par.M;
      if (k === order) break;
      v[k + 1] = (absolute[k] - (k <= highest ? A[k] : 0)) / (k + 1);
      x[k + 1] = v[k] / (k + 1);
    }
  }

  // Rocking on the base, eqs (3)-(6): M X + m (c phi')' = -F; m c X + J phi'' = -m g n; X = a_g + x''.
  function onBase(par, order, highest, factors) {
    const { phi, w, S, C, x, v, F, absolute, ground: A } = P, { M, J, g } = par;
    const mR = par.m * par.R, c0 = mR * C[0], scale = 1 / (M * J - c0 * c0);
    for (let k = 0; k <= order; k++) {
      if (k > 0) {
        let sine = 0;
        for (let j = 0; j < k; j++) sine += w[j] * C[k - 1 - j];
        S[k] = -sine / k;
        bearingTerm(par, k, factors);
      }
      let cosine = 0;
      for (let j = 0; j <= k; j++) cosine += w[j] * S[k - j];
      C[k + 1] = cosine / (k + 1);
      let momentum = C[k + 1] * w[0], lever = 0;
      for (let j = 1; j <= k; j++) {
        momentum += C[j] * w[k + 1 - j];
        lever += C[j] * absolute[k - j];
      }
      const push = -P.F[k] - mR * (k + 1) * momentum, moment = -mR * (g * S[k] + lever);
      absolute[k] = (J * push - c0 * moment) * scale;
      if (k === order) break;
      w[k + 1] = ((M * moment - c0 * push) * scale) / (k + 1);
      phi[k + 1] = w[k] / (k + 1);
      v[k + 1] = (absolute[k] - (k <= highest ? A[k] : 0)) / (k + 1);
      x[k + 1] = v[k] / (k + 1);
    }
  }

  function raised(h, order) { // faster than Math.pow
    let power = 1;
    for (let k = 0; k < order; k++) power *= h;
    return power;
  }

  // Largest step up to h whose last terms stay below tolerance times the size of f in that very step.
  function allowedStep(f, order, tolerance, h) {
    for (;;) {
      const limit = tolerance * Math.max(Math.abs(f[0]) + Math.abs(f[1]) * h + Math.abs(f[2]) * h * h, NEGLIGIBLE);
      const power = raised(h, order - 1), last = Math.abs(f[order]) * power * h, before = Math.abs(f[order - 1]) * power;
      let shrink = 1;
      if (last > limit) shrink = 0.9 * Math.pow(limit / last, 1 / order);
      if (before > 4 * limit) shrink = Math.min(shrink, 0.9 * Math.pow((4 * limit) / before, 1 / (order - 1)));
      if (!(shrink < 1)) return h;
      h *= Math.max(shrink, MOST_SHRINK);
    }
  }

  // Order that a hop of `length` [1/omega_r] needs.
  function hopOrder(length, order, tolerance) {
    if (length >= 0.25) return order;
    return Math.min(order, Math.max(5, Math.trunc(Math.log(0.01 * tolerance) / Math.log(2 * length)) + 3));
  }

  return { P, groundSeries, rigid, contact, onBase, allowedStep, hopOrder };
})();
