"use strict";
// A scene as numbers: constants of block, base and bearings, eqs (1), (7), (8), (13), (14); and the ground motion.
const Scene = (() => {
  const GRAVITY = 9.81; // m/s2
  const QUIET = 0, SAMPLED = 1, HARMONIC = 2; // kinds of ground motion

  // scene: { slenderness [rad], radius [m], mass [kg], restitution (null: eq. (7)), base (null, or { mass [kg], count,
  // ka, kb [N/m], alpha, deltaK }), start (tilt [rad]), startRate [rad/s] }.
  function parameters(scene) {
    const { slenderness: gamma, radius: R, mass: m, base } = scene;
    const M = m + (base ? base.mass : 0), J = (4 / 3) * m * R * R, mt = base ? m / M : 0;
    const b = R * Math.sin(gamma), h = R * Math.cos(gamma);
    const byMomentum = 1 - (2 * m * b * b) / (J - m * mt * h * h); // (7)
    const e = scene.restitution ?? Math.max(byMomentum, 0);
    const bearing = base ? bearingConstants(base) : { count: 0, kb: 0, dk: 0, alpha: 2, d0: 1, f0: 0 };
    return {
      m, M, J, R, gamma, g: GRAVITY, mt, e, byMomentum, onBase: !!base, ...bearing,
      p2: (m * GRAVITY * R) / J, // (1)
      tilt: scene.start ?? 0, rate: scene.startRate ?? 0,
    };
  }

  function bearingConstants({ count, ka, kb, alpha, deltaK = 1e-20 }) {
    const dk = ka - kb, x0 = 0.5 * (Math.pow(deltaK / dk, -1 / alpha) - 1); // (13)
    const d0 = Math.pow(1 + 2 * x0, 1 - alpha);
    return { count, kb, dk, alpha, d0, f0: (0.5 * dk * (d0 - 1)) / (1 - alpha) }; // (14)
  }

  const quiet = () => ({ kind: QUIET, end: 0, scale: 0, frequency: 0 });

  // One full sine: amplitude [m/s2], period [s].
  const pulse = (amplitude, period) => ({
    kind: HARMONIC, scale: amplitude, frequency: (2 * Math.PI) / period, end: period,
  });

  // Accelerations [m/s2] at equal intervals dt [s], linear in between, zero afterwards.
  const sampled = (samples, dt, scale) => ({
    kind: SAMPLED, samples, dt, scale, frequency: 0, end: (samples.length - 1) * dt,
  });

  // a_g [m/s2] at t [s].
  function acceleration(ground, t) {
    if (t < 0 || t > ground.end || ground.kind === QUIET) return 0;
    if (ground.kind === HARMONIC) return ground.scale * Math.sin(ground.frequency * t);
    const i = Math.min(Math.floor(t / ground.dt), ground.samples.length - 2), u = t / ground.dt - i;
    return ground.scale * (ground.samples[i] * (1 - u) + ground.samples[i + 1] * u);
  }

  // Hysteretic force [N] of one bearing after travel dx [m] from z [N], eqs (9), (11) less their kb x.
  function hysteretic(par, z, dx) {
    if (dx === 0) return z;
    const s = Math.sign(dx), travel = virtualTravel(par, s, z) + Math.abs(dx);
    return s * ((par.dk * (Math.pow(travel, 1 - par.alpha) - par.d0)) / (1 - par.alpha) + par.f0);
  }

  // D_c [m]: where the point with hysteretic force z stands on the limit curve of direction s, eqs (10), (12).
  function virtualTravel(par, s, z) {
    const power = par.d0 + ((1 - par.alpha) * (s * z - par.f0)) / par.dk;
    return Math.pow(Math.max(par.d0, power), 1 / (1 - par.alpha));
  }

  return { GRAVITY, QUIET, SAMPLED, HARMONIC, parameters, quiet, pulse, sampled, acceleration, hysteretic,
    virtualTravel };
})();
