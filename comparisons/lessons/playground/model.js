"use strict";
// The event-driven model: full contact, uplift, rocking, impact, rest, re-uplift, overturning. analytic/kernel/march.py with
// its steps, events and decision in JavaScript: Taylor steps whose events are roots of the step's own polynomials.
const Model = (() => {
  const { value, firstRoot, bracketedRoot } = Polynomial, { P } = Series;
  const ORDER = 18, SHORT_ORDER = 8, TOLERANCE = 1e-11, REST_RATE = 1e-8, ELASTIC_REST_RATE = 1e-4;
  const LONGEST_LAST_HOP = 1e-3, NEARLY_ELASTIC = 0.999, NO_RATE = 1e-15, TOUCH = 1e-9, ONSET = 1e-9, ROUNDING = 4e-16;
  const MOST_STEPS = 2e5; // a guard: a nearly elastic block hops for ever

  const sign = (y) => (y < 0 || Object.is(y, -0) ? -1 : 1);

  // --- events inside a step -------------------------------------------------------------------------------------

  function findUplift(row, order, threshold, refused, h) {
    let size = Math.abs(row[0]), found = -1;
    for (let k = 1, power = 1; k <= order; k++) size += Math.abs(row[k]) * (power *= h);
    if (size < threshold) return -1;
    for (const side of [-1, 1]) {
      const event = P.event;
      for (let k = 0; k <= order; k++) event[k] = side * row[k];
      event[0] += threshold;
      if (refused && Math.abs(event[0]) <= TOUCH * threshold) {
        event[0] = 0; // the touch just refused; a later crossing still counts
        if (event[1] < 0) continue;
      }
      const root = firstRoot(event, order, h);
      if (root >= 0) found = h = root;
    }
    return found;
  }

  // factor f + constant falls below 0.
  function findFall(f, factor, constant, order, h) {
    let lowest = constant + factor * f[0];
    for (let k = 1, power = 1; k <= order; k++) lowest -= Math.abs(f[k]) * (power *= h);
    if (lowest > 0) return -1;
    for (let k = 0; k <= order; k++) P.event[k] = factor * f[k];
    P.event[0] += constant;
    return firstRoot(P.event, order, h);
  }

  // Time of the step's first event [s], named in st.found; h without one.
  function firstEvent(par, st, order, h) {
    st.found = null;
    if (!st.s) {
      const threshold = par.g * Math.tan(par.gamma), row = par.onBase ? P.absolute : P.ground;
      if (Math.abs(row[0]) > threshold && !st.refused) {
        st.found = "uplift";
        return 0;
      }
      const root = findUplift(row, order, threshold, st.refused, h);
      if (root >= 0) [st.found, h] = ["uplift", root];
    } else {
      for (let k = 0; k <= order; k++) P.event[k] = st.s * P.phi[k];
      let root = firstRoot(P.event, order, h); // a root at the start is the event just left
      if (root >= 0) [st.found, h] = ["impact", root];
      if (st.s * st.tilt < par.gamma) {
        root = findFall(P.phi, -st.s, par.gamma, order, h);
        if (root >= 0) [st.found, h] = ["passage", root];
      }
      root = findFall(P.phi, -st.s, 0.5 * Math.PI, order, h);
      if (root >= 0) [st.found, h] = ["overturning", root];
    }
    if (st.direction) {
      const root = findFall(P.v, st.direction, 0, order, h);
      if (root > 0) [st.found, h] = ["reversal", root];
    }
    return h;
  }

  // --- impact and rest ------------------------------------------------------------------------------------------

  // -s phi'' at phi = 0 on side s [rad/s2], from eqs (3)-(6); positive where gravity brings the block back.
  function hopDeceleration(par, s, ground, force) {
    const h = par.R * Math.cos(par.gamma), b = s * par.R * Math.sin(par.gamma);
    if (!par.onBase) return (s * par.m * (h * ground + par.g * b)) / par.J;
    return (s * (par.M * par.m * par.g * b - par.m * h * force)) / (par.M * par.J - (par.m * h) ** 2);
  }

  // Time that the impacts after one with rate `rate` still take [s]: a geometric series; -1: they do not end in rest.
  function remainingHops(par, rate, ground, force) {
    const s = rate > 0 ? 1 : -1, w = Math.abs(rate);
    const here = hopDeceleration(par, s, ground, force), there = hopDeceleration(par, -s, ground, force);
    if (here <= 0 || there <= 0) {
      const touching = Math.min(here, there) >= -TOUCH * par.p2;
      return touching && w < NO_RATE * Math.sqrt(par.p2) ? 0 : -1;
    }
    if (2 * w > (LONGEST_LAST_HOP / Math.sqrt(par.p2)) * Math.min(here, there)) return -1;
    if (par.e > NEARLY_ELASTIC) return 0;
    return (2 * w * (1 / here + par.e / there)) / (1 - par.e * par.e);
  }

  function land(par, st, ground, restRate, result) {
    const before = st.rate, lever = par.mt * par.R * Math.cos(par.gamma);
    st.rate = par.e * before; // (7)
    const jump = lever * (before - st.rate); // (8), from momentum
    st.v += jump;
    result.impacts.push([st.t, before, st.rate, jump]);
    st.s = sign(st.rate);
    st.tilt = 0;
    let remaining = -1;
    const force = par.count * (par.kb * st.x + st.z);
    if (st.rate === 0 || Math.abs(st.rate) < restRate) remaining = remainingHops(par, st.rate, ground, force);
    if (st.rate !== 0 && remaining < 0) return;
    st.v += lever * st.rate; // the hops left out: their momentum stays with the base
    st.rate = st.s = 0;
    if (remaining >= 0) result.rests.push(st.t + remaining);
  }

  // --- when the outcome is decided ------------------------------------------------------------------------------

  // Energy [J] that can still reach the block after the motion, see analytic/kernel/decision.py.
  function remainingEnergy(par, st) {
    const c = st.s ? par.R * Math.cos(st.s * par.gamma - st.tilt) : 0, { m, M, J, g, R, gamma } = par;
    const a = Math.abs(st.tilt);
    const energy = 0.5 * J * st.rate ** 2 + 2 * m * g * R * Math.sin(gamma - 0.5 * a) * Math.sin(0.5 * a);
    if (!par.onBase) return energy;
    return energy + 0.5 * M * st.v ** 2 + m * c * st.v * st.rate + par.count * (0.5 * par.kb * st.x ** 2 + recoverable(par, st.z));
  }

  // What the hysteresis of one bearing can give back [J]: |z| dx on the way back to z = 0.
  function recoverable(par, force) {
    const z = Math.abs(force), a = par.alpha - 1, { dk, d0, f0 } = par;
    if (z === 0) return 0;
    const begin = -Math.log(d0 + (a * (f0 + z)) / dk) / a, end = -Math.log(d0 + (a * f0) / dk) / a;
    const length = end - begin;
    if (end > 600) return Infinity;
    const power = Math.abs((1 - a) * length) < 1e-8 ? length : Math.expm1((1 - a) * length) / (1 - a);
    const travel = Math.exp(begin) * Math.expm1(length);
    return Math.max((0.5 * z * z) / dk, (dk / a) * Math.exp((1 - a) * begin) * power - (f0 + (dk * d0) / a) * travel);
  }

  // "overturns", "rocks", "stands", or null while it is open. Only after the motion.
  function decision(par, st, lifted) {
    if (!par.onBase && !st.s) return lifted ? "rocks" : "stands";
    const energy = remainingEnergy(par, st), barrier = par.m * par.g * par.R * (1 - Math.cos(par.gamma));
    if (lifted && energy < barrier && Math.abs(st.tilt) < par.gamma) return "rocks";
    if (!par.onBase) {
      const outward = st.s * st.rate >= 0;
      if (st.s * st.tilt >= par.gamma) return outward || energy < barrier ? "overturns" : null;
      if (outward) return "overturns";
      // first back through an impact, which leaves e^2 of the kinetic energy there
      st.coming = par.e * par.e * energy > barrier ? 1 : 0;
      return st.coming ? "overturns" : "rocks";
    }
    if (st.s) return null;
    const force = Math.min(
      Math.sqrt(2 * energy * par.count * (par.kb + par.dk)),
      par.count * par.f0 + Math.sqrt(2 * energy * par.count * par.kb),
    );
    return force < par.M * par.g * Math.tan(par.gamma) ? (lifted ? "rocks" : "stands") : null;
  }

  // --- one run --------------------------------------------------------------------------------------------------

  const factors = { over: 0, power: 0, slope: 0 }; // of the bearing's series

  // Series of a step from the state, of order st.used; returns the step allowed.
  function seriesOfStep(par, st, kind, a0, slope, ground, options, order, h) {
    const u = ground.frequency * st.t, tolerance = options.tolerance;
    if (kind === Scene.HARMONIC) h = Math.min(h, 1 / ground.frequency);
    const highest = Series.groundSeries(kind, a0, slope, ground.frequency, u, order);
    if (par.onBase) prepareBearing(par, st, highest);
    st.used = order;
    if (!st.s) {
      if (!par.onBase) {
        for (let k = highest + 1; k <= order; k++) P.ground[k] = 0;
        return h;
      }
      Series.contact(par, order, highest, factors);
      return Series.allowedStep(P.F, order, tolerance, Series.allowedStep(P.v, order, tolerance, h));
    }
    const angle = st.s * par.gamma - st.tilt;
    [P.phi[0], P.w[0], P.S[0], P.C[0]] = [st.tilt, st.rate, Math.sin(angle), Math.cos(angle)];
    let used = order, reach = h;
    if (st.tilt === 0 && st.rate !== 0 && kind !== Scene.SAMPLED) {
      const back = hopDeceleration(par, st.s, highest >= 0 ? P.ground[0] : 0, P.F[0]);
      if (back > 0) {
        const hop = (2 * Math.abs(st.rate)) / back;
        used = Series.hopOrder(Math.sqrt(par.p2) * hop, order, tolerance);
        if (used < order) reach = Math.min(h, 1.2 * hop);
      }
    }
    for (;;) {
      let good = reach;
      if (par.onBase) {
        Series.onBase(par, used, highest, factors);
        good = Series.allowedStep(P.F, used, tolerance, Series.allowedStep(P.v, used, tolerance, good));
      } else Series.rigid(par, used, highest);
      if (st.fresh) P.phi[2] = P.w[1] = 0; // the onset is of third order
      good = Series.allowedStep(P.w, used, tolerance, good);
      st.used = used;
      if (used === order || good === reach) return good;
      [used, reach] = [order, h]; // the hop was longer than it looked
    }
  }

  // Base and bearing at the start of a step; a new branch of the loop where the travel turns.
  function prepareBearing(par, st, highest) {
    const force = par.count * (par.kb * st.x + st.z);
    P.x[0] = st.x;
    P.v[0] = st.v;
    P.F[0] = force;
    let moving = st.v === 0 ? 0 : sign(st.v);
    if (st.v === 0) {
      let absolute = -force / par.M; // (2)
      if (st.s) {
        const angle = st.s * par.gamma - st.tilt;
        const c = par.m * par.R * Math.cos(angle), n = par.m * par.R * Math.sin(angle);
        absolute = (par.J * (-force - n * st.rate ** 2) + c * par.g * n) / (par.M * par.J - c * c); // (3)-(6) solved
      }
      let start = absolute - (highest >= 0 ? P.ground[0] : 0);
      if (start === 0 && highest >= 1) start = -P.ground[1];
      moving = Math.sign(start);
    }
    if (moving && moving !== st.direction) {
      st.direction = moving;
      st.turn = st.x;
      st.mark = Scene.virtualTravel(par, moving, st.z);
      st.power = Math.pow(st.mark, 1 - par.alpha);
    }
    const s = st.direction, travel = st.mark + s * (st.x - st.turn);
    P.q[0] = s ? st.power : 0;
    factors.over = s / travel;
    factors.power = 2 - par.alpha;
    factors.slope = (s * par.dk) / (1 - par.alpha);
  }

  // State at the end of a step of length h.
  function advance(par, st, order, h, result) {
    if (st.s) {
      const tilt = value(P.phi, order, h), rate = value(P.w, order, h);
      if (st.s * st.rate >= 0 && st.s * rate < 0) {
        for (let k = 0; k <= order; k++) P.event[k] = st.s * P.w[k];
        const top = Math.abs(value(P.phi, order, bracketedRoot(P.event, 0, order, 0, h)));
        result.peakTilt = Math.max(result.peakTilt, top);
      }
      [st.tilt, st.rate] = [tilt, rate];
      result.peakTilt = Math.max(result.peakTilt, Math.abs(tilt));
    }
    if (!par.onBase) return;
    st.x = value(P.x, order, h);
    st.v = st.found === "reversal" ? 0 : value(P.v, order, h);
    const s = st.direction;
    if (s) {
      st.power = Math.pow(st.mark + s * (st.x - st.turn), 1 - par.alpha);
      st.z = s * ((par.dk * (st.power - par.d0)) / (1 - par.alpha) + par.f0); // (9), (11)
    }
    result.widest = Math.max(result.widest, Math.abs(st.x));
  }

  function write(par, st, rows, t, d, order) {
    if (!rows) return;
    const rocking = st.s !== 0, base = par.onBase;
    rows.push([
      t, rocking ? value(P.phi, order, d) : 0, rocking ? value(P.w, order, d) : 0,
      base ? value(P.x, order, d) : 0, base ? value(P.v, order, d) : 0, base ? value(P.F, order, d) : 0,
    ]);
  }

  const now = (par, st) => [st.t, st.tilt, st.rate, st.x, st.v, par.count * (par.kb * st.x + st.z)];

  // Stretch of ground motion without a corner: between two samples, a pulse, or nothing.
  function stretch(ground, segment, { duration, order, short }) {
    if (ground.kind === Scene.SAMPLED && segment < ground.samples.length - 1) {
      const a0 = ground.scale * ground.samples[segment];
      const slope = (ground.scale * ground.samples[segment + 1] - a0) / ground.dt;
      const kind = a0 || slope ? Scene.SAMPLED : Scene.QUIET;
      return { kind, a0, slope, finish: Math.min((segment + 1) * ground.dt, duration), order: short };
    }
    const shaking = ground.kind === Scene.HARMONIC && segment === 0;
    const finish = shaking ? Math.min(ground.end, duration) : duration;
    return { kind: shaking ? ground.kind : Scene.QUIET, a0: shaking ? ground.scale : 0, slope: 0, finish, order };
  }

  // What an event at the end of a step does; keep() is called before and after an impact.
  function happen(par, st, ground, used, step, keep, result) {
    if (st.found === "uplift") {
      const onset = value(par.onBase ? P.absolute : P.ground, used, step);
      [st.s, st.tilt, st.rate] = [-sign(onset), 0, 0];
      st.fresh = Math.abs(onset) < par.g * (1 + ONSET) * Math.tan(par.gamma);
      result.uplifts.push(st.t);
    } else if (st.found === "impact") {
      const restRate = (par.e > NEARLY_ELASTIC ? ELASTIC_REST_RATE : REST_RATE) * Math.sqrt(par.p2);
      keep();
      land(par, st, Scene.acceleration(ground, st.t), restRate, result);
      keep();
    } else if (st.found === "passage") {
      st.tilt = st.s * par.gamma;
    } else if (st.found === "overturning") {
      st.tilt = st.s * 0.5 * Math.PI;
      [result.peakTilt, result.overturning] = [0.5 * Math.PI, st.t];
    }
  }

  const hasLifted = (par, result) => result.uplifts.length > 0 || par.tilt !== 0 || par.rate !== 0;

  // given: duration [s]; decide: end when the outcome is certain, but not before `shortest` [s]; outputStep [s]: rows
  // (t, tilt, rate, x, v, F) at its multiples, those after `shortest` left out where it is given; corners: rows before
  // and after each impact as well; tolerance; order, short: of the series, between samples.
  function simulate(par, ground, given) {
    const options = { tolerance: TOLERANCE, order: ORDER, short: SHORT_ORDER, shortest: 0, outputStep: 0, ...given };
    const rows = options.outputStep > 0 ? [] : null, until = options.shortest || options.duration;
    const result = { rows, impacts: [], uplifts: [], rests: [], peakTilt: Math.abs(par.tilt), peakX: 0, steps: 0,
      widest: 0 }; // |x| so far; what it gains in the last fall does not count
    const st = { t: 0, tilt: par.tilt, rate: par.rate, x: 0, v: 0, z: 0, s: 0, direction: 0, turn: 0, mark: 1, power: 0,
      fresh: false, refused: false, found: null, used: 0, coming: 0 };
    if (st.tilt || st.rate) st.s = sign(st.tilt || st.rate);
    const keep = () => rows && options.corners && st.t <= until && rows.push(now(par, st));
    const early = options.shortest * (1 - ROUNDING);
    let outcome = null, begin = 0, written = 0;
    for (let segment = 0; begin < options.duration && !outcome; segment++) {
      const { kind, a0, slope, finish, order } = stretch(ground, segment, options), length = finish - begin;
      const after = options.decide && kind === Scene.QUIET && begin >= ground.end;
      for (let tau = 0; tau < length && !outcome; ) {
        st.t = begin + tau;
        let h = length - tau;
        if (h <= ROUNDING * finish) break;
        if (after && st.t < early) h = Math.min(h, options.shortest - st.t);
        else if (after && (outcome = decision(par, st, hasLifted(par, result)))) break;
        const allowed = seriesOfStep(par, st, kind, a0 + slope * tau, slope, ground, options, order, h), { used } = st;
        if (st.fresh && st.s && !(st.s * P.phi[3] > 0)) { // only touched the threshold: the block stays down
          [st.s, st.fresh, st.refused] = [0, false, true];
          result.uplifts.pop();
          continue;
        }
        const step = firstEvent(par, st, used, Math.min(h, allowed)), { found } = st;
        while (rows && (step > 0 || st.t === 0) && written * options.outputStep <= Math.min(st.t + step, until)) {
          const at = options.outputStep * written++;
          write(par, st, rows, at, Math.min(Math.max(at - st.t, 0), step), used);
        }
        advance(par, st, used, step, result);
        if (step > 0) st.fresh = st.refused = false;
        tau = !found && step === length - tau ? length : tau + step;
        st.t = begin + tau;
        happen(par, st, ground, used, step, keep, result);
        if (Math.abs(st.tilt) <= par.gamma) result.peakX = result.widest;
        if (++result.steps > MOST_STEPS) outcome = "undecided";
        if (found === "overturning") outcome = "overturns";
      }
      begin = finish;
    }
    const lifted = hasLifted(par, result);
    if (outcome !== "overturns") result.peakX = result.widest;
    if (outcome === null && begin >= ground.end) outcome = decision(par, st, lifted);
    result.outcome = outcome ?? (lifted ? "rocks" : "stands");
    result.coming = st.coming; // impacts still to come before a certain fall
    result.end = now(par, st);
    return result;
  }

  return { simulate, ORDER, TOLERANCE };
})();
