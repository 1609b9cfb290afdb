"use strict";
// What an engine would do: two made-up engines, each with one error of its own, beside the event-driven model.
const Engines = (() => {
  const BEARING_STEP = 2.5e-4; // s, in which a soft engine's bearings follow their law

  const sign = (y) => (y < 0 || Object.is(y, -0) ? -1 : 1);

  // The exact equations and impact law in steps of equal length [s]: semi-implicit Euler; an impact is detected only at
  // the end of the step that contains it. analytic/checks/time_stepping.py in JavaScript.
  function straddling(par, ground, { step, duration }) {
    const { m, M, J, R, gamma, g, onBase } = par, count = Math.ceil((duration / step) * (1 - 1e-12));
    const arm = par.mt * R * Math.cos(gamma), threshold = g * Math.tan(gamma), rows = [], impacts = [];
    let tilt = par.tilt, rate = par.rate, x = 0, v = 0, z = 0, side = tilt || rate ? sign(tilt || rate) : 0;
    for (let k = 0; k <= count; k++) {
      const t = k * step, a = Scene.acceleration(ground, t), force = par.count * (par.kb * x + z);
      rows.push([t, tilt, rate, x, v, force]);
      if (Math.abs(tilt) >= Math.PI / 2) return { rows, impacts, overturned: true };
      let absolute = onBase ? -force / M : a, spin = 0; // (2)
      if (!side && Math.abs(absolute) > threshold) side = -sign(absolute);
      if (side) {
        const c = R * Math.cos(side * gamma - tilt), n = R * Math.sin(side * gamma - tilt);
        spin = (-m * (c * a + g * n)) / J; // (4)
        absolute = a;
        if (onBase) { // (3)-(6) solved
          const push = -m * n * rate * rate - force, moment = -m * g * n, determinant = M * J - (m * c) ** 2;
          spin = (M * moment - m * c * push) / determinant;
          absolute = (J * push - m * c * moment) / determinant;
        }
      }
      if (k === count) break;
      rate += step * spin;
      tilt += step * rate;
      if (onBase) {
        v += step * (absolute - a);
        x += step * v;
        z = Scene.hysteretic(par, z, step * v);
      }
      if (side && side * tilt <= 0 && side * rate < 0) { // too late by a part of the step
        const before = rate;
        rate = par.e * before; // (7)
        if (onBase) v += arm * (before - rate); // (8)
        impacts.push([t + step, before, rate]);
        side = -side;
        if (Math.abs(rate) <= Math.abs(spin) * step) {
          v += arm * rate;
          tilt = rate = side = 0;
        }
      }
    }
    return { rows, impacts, overturned: false };
  }

  // A free body on two corners that give way: springs and dampers without tension, which stick. `sink` [m]: by how much
  // the standing block sinks in. No restitution is given; it comes out. Steps of a share of the corner's own period.
  function soft(par, ground, { sink, duration, every }) {
    const { m, R, gamma, g, onBase } = par, mb = par.M - m, b = R * Math.sin(gamma), h = R * Math.cos(gamma);
    const inertia = par.J - m * R * R, k = (m * g) / (2 * sink);
    // dampers of twice the critical value for the mass that a corner feels when it is struck along its normal
    const felt = 1 / (1 / m + (b * b) / inertia), c = 4 * Math.sqrt(k * felt);
    const stiffest = Math.sqrt(k * (2 / m + (R * R) / inertia + (onBase ? 1 / mb : 0)));
    const fastest = c * (2 / m + (R * R) / inertia + (onBase ? 1 / mb : 0));
    const step = Math.min(0.2 / stiffest, 0.2 / fastest, every), count = Math.ceil(duration / step);
    const s0 = par.tilt ? sign(par.tilt) : 0, down = s0 ? 2 * sink : sink;
    let tilt = par.tilt, w = par.rate, x = 0, v = 0, z = 0; // block's turn; base's displacement; bearing
    let X = s0 ? s0 * b - (s0 * b * Math.cos(tilt) - h * Math.sin(tilt)) : 0, U = 0; // centre
    let Z = s0 ? s0 * b * Math.sin(tilt) + h * Math.cos(tilt) - down : h - down, W = 0;
    const anchors = [null, null], rows = [];
    const skip = Math.max(1, Math.floor(BEARING_STEP / step));
    let next = 0, followed = 0; // place up to which the bearings have followed
    for (let i = 0; i <= count; i++) {
      const t = i * step, a = Scene.acceleration(ground, t), force = par.count * (par.kb * x + z);
      if (t >= next * every) {
        rows.push([t, tilt, w, x, v, force]);
        next++;
      }
      if (Math.abs(tilt) >= Math.PI / 2) return { rows, overturned: true };
      const co = Math.cos(tilt), si = Math.sin(tilt);
      let T = 0, N = 0, moment = 0; // of the corners on the block; moment clockwise
      for (let j = 0; j < 2; j++) {
        const u = j ? b : -b, rx = u * co - h * si, rz = -u * si - h * co;
        const gap = Z + rz, place = X + rx - x;
        if (gap >= 0) {
          anchors[j] = null;
          continue;
        }
        anchors[j] ??= place;
        const normal = Math.max(0, -k * gap - c * (W - w * rx));
        if (normal === 0) continue;
        const along = -k * (place - anchors[j]) - c * (U + w * rz - v);
        T += along;
        N += normal;
        moment += rz * along - rx * normal;
      }
      U += step * (T / m - a);
      W += step * (N / m - g);
      w += (step * moment) / inertia;
      X += step * U;
      Z += step * W;
      tilt += step * w;
      if (onBase) {
        v += step * ((-T - force) / mb - a);
        x += step * v;
        if (i % skip === 0) [z, followed] = [Scene.hysteretic(par, z, x - followed), x];
      }
    }
    return { rows, overturned: false };
  }

  return { straddling, soft };
})();
