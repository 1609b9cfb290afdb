"use strict";
// What a worker computes: bands of the overturning map, and what an engine would do. A worker is made from a Blob of
// these very scripts: a page opened from a file can load no other.
const Jobs = (() => {
  const STANDS = 0, ROCKS = 1, AT_ONCE = 2, AFTER_IMPACTS = 3, OPEN = 4; // values of a cell
  const LONGEST = 100; // rocking periods after the motion, as in analytic/kernel/decision.py

  const groundOf = (motion, samples) => {
    if (motion.kind === "pulse") return Scene.pulse(motion.amplitude, motion.period);
    return motion.kind === "synthetic" ? Scene.sampled(samples.values, samples.dt, motion.scale) : Scene.quiet();
  };

  const longest = (par, ground) => ground.end + (LONGEST * 2 * Math.PI) / Math.sqrt(par.p2);

  function cell(scene, motion, samples) {
    const par = Scene.parameters(scene), ground = groundOf(motion, samples);
    const options = { duration: longest(par, ground), decide: true, tolerance: 1e-7, order: 12, short: 6 };
    const run = Model.simulate(par, ground, options);
    if (run.outcome === "overturns") return run.impacts.length + run.coming ? AFTER_IMPACTS : AT_ONCE;
    return run.outcome === "stands" ? STANDS : run.outcome === "rocks" ? ROCKS : OPEN;
  }

  // Rows [from, to) of a map of nx by ny cells, each in its middle; axes: [across, up], { key, low, high, unit }, the
  // key one of the scene's or the motion's, `unit` the worth of 1 on the axis in it.
  function band({ scene, motion, axes: [across, up], nx, ny, from, to }, samples) {
    const cells = new Uint8Array((to - from) * nx);
    const put = (axis, share, parts) => {
      const value = (axis.low + (axis.high - axis.low) * share) * axis.unit;
      parts[axis.key in parts[1] ? 1 : 0][axis.key] = value;
    };
    for (let j = from; j < to; j++) {
      for (let i = 0; i < nx; i++) {
        const parts = [{ ...scene }, { ...motion }];
        put(across, (i + 0.5) / nx, parts);
        put(up, (j + 0.5) / ny, parts);
        cells[(j - from) * nx + i] = cell(...parts, samples);
      }
    }
    return { nx, ny, from, to, cells };
  }

  function ghost({ scene, motion, engine, duration, every }, samples) {
    const par = Scene.parameters(scene), ground = groundOf(motion, samples);
    if (engine.kind === "soft") return Engines.soft(par, ground, { sink: engine.sink, duration, every });
    return Engines.straddling(par, ground, { step: engine.step, duration });
  }

  const run = (job, samples) => (job.kind === "band" ? band(job, samples) : ghost(job, samples));

  return { run, groundOf, longest, STANDS, ROCKS, AT_ONCE, AFTER_IMPACTS, OPEN };
})();
