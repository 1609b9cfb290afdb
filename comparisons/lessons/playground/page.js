"use strict";
// The playground: sliders to a scene, a scene to pictures, again with every move.
const Playground = (() => {
  const G = Scene.GRAVITY, OUTPUT_STEP = 0.01; // s
  const samples = decode(document.getElementById("motion"));
  const log = (low, high) => ({ low: Math.log10(low), high: Math.log10(high), to: (v) => 10 ** v, from: Math.log10 });

  // key: [group, label, unit, range and step, digits]
  const SLIDERS = {
    slenderness: ["block", "slenderness <var>γ</var>", "rad", { low: 0.1, high: 0.5, step: 0.005 }, 3],
    radius: ["block", "size <var>R</var>", "m", { low: 0.3, high: 6, step: 0.01 }, 2],
    restitution: ["block", "restitution <var>e</var>", "", { low: 0.2, high: 0.98, step: 0.01 }, 3],
    amplitude: ["pulse", "amplitude", "g", { low: 0, high: 2, step: 0.01 }, 2],
    period: ["pulse", "period", "s", { low: 0.1, high: 2.5, step: 0.01 }, 2],
    scale: ["synthetic", "scale of the motion", "", { low: 0, high: 2, step: 0.01 }, 2],
    tilt: ["release", "tilt at the start, over <var>γ</var>", "", { low: 0.02, high: 0.99, step: 0.01 }, 2],
    mass: ["bearings", "block’s mass <var>m</var>", "kg", { low: 500, high: 8000, step: 50 }, 0],
    baseMass: ["bearings", "base’s mass <var>m</var><sub>b</sub>", "kg", { low: 50, high: 4000, step: 2 }, 0],
    ka: ["bearings", "stiffness <var>k</var><sub>a</sub>", "kN/m", { low: 10, high: 300, step: 0.2 }, 1],
    ratio: ["bearings", "<var>k</var><sub>b</sub>/<var>k</var><sub>a</sub>", "", { low: 0.02, high: 0.9, step: 0.01 }, 2],
    alpha: ["bearings", "exponent <var>α</var>", "", { ...log(5, 500), step: 0.00001 }, 2],
    step: ["straddling", "step", "ms", { ...log(0.5, 50), step: 0.01 }, 2],
    sink: ["soft", "static sink", "mm", { ...log(0.05, 5), step: 0.01 }, 2],
  };
  const CARYATID = {
    slenderness: 0.28, radius: 1.0884, momentum: true, restitution: 0.88, base: false, mass: 3172.05, baseMass: 212,
    ka: 62.2, ratio: 0.1, alpha: 44.69, motion: "pulse", amplitude: 0.6, period: 0.8, scale: 1, tilt: 0.6,
    engine: "none", step: 10, sink: 1,
  };
  const PRESETS = {
    "pulse": {},
    "free-standing": { motion: "synthetic" },
    "isolated": { motion: "synthetic", base: true },
    "release": { motion: "release", tilt: 0.9 },
    "engine": { amplitude: 0.4, engine: "straddling", step: 20 },
  };
  const WINDOW = { pulse: 10, synthetic: 16, release: 10 }; // s shown
  const STAGES = { // of the map, coarse to fine: cells across and up
    pulse: [[12, 8], [24, 16], [48, 32], [96, 64]], synthetic: [[6, 4], [12, 8], [24, 16], [48, 32]],
  };
  const BAND = 96; // cells asked for at once
  const REST = 300; // ms without a change, after which the map is refined

  const state = { ...CARYATID }, $ = (id) => document.getElementById(id);
  let par, ground, run, ghost = null, cells = null, time = 0, playing = false, mapRun = 0, changed = 0;

  function decode(element) {
    const bytes = Uint8Array.from(atob(element.textContent.trim()), (c) => c.charCodeAt(0));
    return { values: new Float64Array(bytes.buffer), dt: +element.dataset.step, peak: +element.dataset.peak };
  }

  // --- from the sliders to what the model knows -----------------------------------------------------------------

  const scene = () => ({
    slenderness: state.slenderness, radius: state.radius, mass: state.mass,
    restitution: state.momentum ? null : state.restitution,
    base: state.base ? { mass: state.baseMass, count: 4, ka: 1e3 * state.ka, kb: 1e3 * state.ka * state.ratio, alpha: state.alpha } : null,
    start: state.motion === "release" ? state.tilt * state.slenderness : 0,
  });
  const motion = () => ({ kind: state.motion, amplitude: state.amplitude * G, period: state.period, scale: state.scale });
  const engine = () => ({ kind: state.engine, step: state.step / 1e3, sink: state.sink / 1e3 });

  function mapAxes() {
    if (state.motion === "release") return null;
    const across = (key, low, high, label) => ({ key, low, high, label, unit: 1 });
    if (state.motion === "pulse") {
      return [across("period", 0.1, 2.5, "period of the pulse [s]"), { ...across("amplitude", 0, 2, "amplitude [g]"), unit: G }];
    }
    return [across("slenderness", 0.1, 0.5, "slenderness γ [rad]"), across("scale", 0, 2, "scale of the motion [–]")];
  }

  // --- what workers compute -------------------------------------------------------------------------------------

  const askGhost = Workers.make(samples), askMap = Workers.make(samples);
  let ghostBusy = false, ghostDue = false, mapBusy = false;

  async function updateGhost() {
    ghostDue = state.engine !== "none";
    if (!ghostDue) ghost = null;
    if (ghostBusy) return;
    ghostBusy = true;
    while (ghostDue) {
      ghostDue = false;
      const job = { kind: "ghost", scene: scene(), motion: motion(), engine: engine(), duration: WINDOW[state.motion], every: OUTPUT_STEP };
      const found = await askGhost(job);
      if (state.engine !== "none") {
        ghost = { ...found, shown: peakOf(found.rows) };
        draw(IN_TIME);
      }
    }
    ghostBusy = false;
  }

  async function updateMap() {
    mapRun++;
    if (mapBusy) return;
    mapBusy = true;
    for (let done = 0; done !== mapRun; ) {
      done = mapRun;
      const axes = mapAxes();
      for (const [nx, ny] of axes ? STAGES[state.motion] : []) {
        if (nx !== STAGES[state.motion][0][0] && !(await rested(done))) break;
        const values = spread(cells, nx, ny), rows = Math.max(1, Math.floor(BAND / nx));
        for (let from = 0; from < ny && done === mapRun; from += rows) {
          const job = { kind: "band", scene: scene(), motion: motion(), axes, nx, ny, from, to: Math.min(from + rows, ny) };
          const found = await askMap(job);
          if (done !== mapRun) break;
          values.set(found.cells, from * nx);
          cells = { nx, ny, values };
          draw(["map"]);
        }
        if (done !== mapRun) break;
      }
    }
    mapBusy = false;
    document.body.dataset.map = "done";
  }

  // Whether nothing changes until REST is over: finer maps wait for a slider that rests, and leave it the processor.
  async function rested(current) {
    const wait = changed + REST - performance.now();
    if (wait > 0) await new Promise((done) => setTimeout(done, wait));
    return current === mapRun;
  }

  // The cells so far on a grid of another size; open where there are none.
  function spread(old, nx, ny) {
    const values = new Uint8Array(nx * ny).fill(Jobs.OPEN);
    if (old) values.forEach((_, k) => {
      const i = Math.floor((((k % nx) + 0.5) / nx) * old.nx), j = Math.floor(((Math.floor(k / nx) + 0.5) / ny) * old.ny);
      values[k] = old.values[j * old.nx + i];
    });
    return values;
  }

  // --- a change -------------------------------------------------------------------------------------------------

  const peakOf = (rows) => rows.reduce((most, row) => Math.max(most, Math.abs(row[1])), 0);

  function update() {
    document.body.dataset.map = "";
    changed = performance.now();
    par = Scene.parameters(scene());
    ground = Jobs.groundOf(motion(), samples);
    ground.peak = state.motion === "synthetic" ? samples.peak : ground.scale;
    run = Model.simulate(par, ground, { duration: Jobs.longest(par, ground), decide: true, shortest: WINDOW[state.motion], outputStep: OUTPUT_STEP, corners: true });
    run.shown = peakOf(run.rows);
    updateGhost();
    updateMap();
    tell();
    draw();
    remember();
  }

  const OUTCOMES = { stands: "stands", rocks: "rocks", overturns: "overturns", undecided: "undecided" };

  // When a picture that stands still tells most: the largest tilt of a block that is not yet falling.
  function telling() {
    const top = Math.min(run.shown, 0.8 * par.gamma) * 0.999;
    return top > 0 ? run.rows.find((row) => Math.abs(row[1]) >= top)[0] : 0;
  }

  // Only what differs: the same words again would cost a layout.
  function write(element, words) {
    if (element.textContent !== words) element.textContent = words;
  }

  function tell() {
    const verdict = $("verdict");
    write(verdict, OUTCOMES[run.outcome]);
    verdict.dataset.outcome = run.outcome;
    const fact = (id, value, words) => {
      write($(id), words);
      $(id).dataset.value = value;
    };
    fact("peak", run.peakTilt, run.outcome === "overturns" ? "falls" : `${(run.peakTilt / par.gamma).toFixed(3)} γ`);
    fact("impacts", run.impacts.length, String(run.impacts.length));
    fact("e", par.e, par.e.toFixed(3));
    fact("displacement", run.peakX, par.onBase ? `${run.peakX.toFixed(3)} m` : "–");
    write($("uplift"), `${Math.tan(par.gamma).toFixed(3)} g`);
    clearTimeout(tell.later);
    tell.later = setTimeout(() => {
      $("said").textContent = `The block ${OUTCOMES[run.outcome]}. Impacts: ${run.impacts.length}.`;
    }, 500);
  }

  function tellGhost() {
    const line = $("ghost-verdict");
    if (line.hidden !== !ghost) line.hidden = !ghost;
    if (!ghost) return;
    const fell = ghost.overturned, wrong = fell !== (run.outcome === "overturns");
    write(line, `engine: ${fell ? "overturns" : "does not overturn"}${wrong ? " – wrong" : ""}`);
    line.dataset.wrong = wrong;
  }

  // --- pictures -------------------------------------------------------------------------------------------------

  let due = false, tiltFrame = null, mapFrame = null;
  const VIEWS = {
    block: (canvas) => {
      const at = Scene.acceleration(ground, time) / (ground.peak || 1), ghostState = ghost && Charts.at(ghost.rows, time);
      Views.block(canvas, { par, state: Charts.at(run.rows, time), ghost: ghostState, ground: at });
    },
    tilt: (canvas) => (tiltFrame = Views.tilt(canvas, { par, run, ghost, window: WINDOW[state.motion], ground, t: time })),
    phase: (canvas) => Views.phase(canvas, { par, run, ghost, t: time }),
    loop: (canvas) => par.onBase && Views.loop(canvas, { run, ghost, t: time }),
    map: (canvas) => {
      const axes = mapAxes();
      if (axes) mapFrame = Views.map(canvas, { cells, axes, place: axes.map((axis) => state[axis.key]) });
    },
  };
  const ALL = Object.keys(VIEWS), IN_TIME = ALL.filter((name) => name !== "map");
  const waiting = new Set(), inSight = new Set(ALL); // to be painted; of these one that is out of sight waits

  function draw(names = ALL) {
    for (const name of names) waiting.add(name);
    if (due) return;
    due = true;
    requestAnimationFrame(() => {
      due = false;
      paint();
    });
  }

  function paint() {
    write($("clock"), `${time.toFixed(2)} s`);
    if (!playing) {
      $("tilt").setAttribute("aria-valuemax", WINDOW[state.motion]);
      $("tilt").setAttribute("aria-valuenow", time.toFixed(2));
      $("tilt").setAttribute("aria-valuetext", `${time.toFixed(2)} s`);
    }
    tellGhost();
    for (const name of waiting) {
      if (!inSight.has(name)) continue;
      waiting.delete(name);
      VIEWS[name]($(name));
    }
  }

  function watchSight() {
    const observer = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        if (isIntersecting) inSight.add(target.id);
        else inSight.delete(target.id);
      }
      if ([...waiting].some((name) => inSight.has(name))) draw([]);
    }, { rootMargin: "100px" });
    for (const name of ALL) observer.observe($(name));
    addEventListener("beforeprint", () => ALL.forEach((name) => VIEWS[name]($(name))));
  }

  let last = null;
  function animate(now) {
    if (!playing) return void (last = null);
    if (last !== null) time += Math.min((now - last) / 1e3, 0.1);
    last = now;
    const end = Math.min(WINDOW[state.motion], run.overturning ? run.overturning + 1.5 : Infinity);
    if (time > end) time = 0;
    for (const name of IN_TIME) waiting.add(name);
    paint();
    requestAnimationFrame(animate);
  }

  function play(on) {
    playing = on;
    $("play").textContent = on ? "Pause" : "Play";
    $("play").setAttribute("aria-pressed", on);
    if (on) requestAnimationFrame(animate);
    else draw(IN_TIME);
  }

  // --- sliders and what else one can touch ----------------------------------------------------------------------

  const inputs = {};
  function build() {
    for (const [key, [group, label, unit, range, digits]] of Object.entries(SLIDERS)) {
      const row = document.createElement("div");
      row.className = "slider";
      row.innerHTML = `<label for="s-${key}">${label}</label><output for="s-${key}" id="o-${key}"></output><input type="range" id="s-${key}" min="${range.low}" max="${range.high}" step="${range.step}">`;
      document.querySelector(`[data-group="${group}"]`).append(row);
      const input = row.querySelector("input");
      inputs[key] = { input, range, unit, digits, row };
      input.addEventListener("input", () => set({ [key]: range.to ? range.to(+input.value) : +input.value }));
    }
    document.querySelector('[data-group="block"]').append($("momentum-row"));
    for (const box of document.querySelectorAll("input[type=radio]")) box.addEventListener("change", () => set({ [box.name]: box.value }));
    $("momentum").addEventListener("change", (event) => set({ momentum: event.target.checked, restitution: Math.min(Math.max(par.e, 0.2), 0.98) }));
    $("base").addEventListener("change", (event) => set({ base: event.target.checked }));
    for (const button of document.querySelectorAll("[data-preset]")) button.addEventListener("click", () => {
      set({ ...CARYATID, ...PRESETS[button.dataset.preset] });
      time = playing ? 0 : telling();
      draw(IN_TIME);
    });
    $("play").addEventListener("click", () => play(!playing));
    Charts.drag($("tilt"), ([px]) => {
      const { left, right } = tiltFrame.box;
      time = Math.min(Math.max((px - left) / (right - left), 0), 1) * WINDOW[state.motion];
      if (playing) play(false);
      else draw(IN_TIME);
    });
    Charts.drag($("map"), ([px, py]) => {
      const { left, right, top, bottom } = mapFrame.box, clip = (u) => Math.min(Math.max(u, 0), 1);
      move([clip((px - left) / (right - left)), clip((bottom - py) / (bottom - top))]);
    });
    $("map").addEventListener("keydown", (event) => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!way || !mapAxes()) return;
      event.preventDefault();
      move(mapAxes().map((axis, i) => Math.min(Math.max((state[axis.key] - axis.low) / (axis.high - axis.low) + way[i] * 0.01, 0), 1)));
    });
    $("tilt").addEventListener("keydown", (event) => {
      const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!way) return;
      event.preventDefault();
      time = Math.min(Math.max(time + way * 0.05, 0), WINDOW[state.motion]);
      if (playing) play(false);
      else draw(IN_TIME);
    });
    new ResizeObserver(() => draw()).observe(document.querySelector("main"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => draw());
    watchSight();
    matchMedia("(prefers-reduced-motion: reduce)").addEventListener("change", (event) => event.matches && play(false));
  }

  // The map's place as shares of its axes, to the sliders.
  function move(shares) {
    const change = {};
    mapAxes().forEach((axis, i) => {
      const { step } = SLIDERS[axis.key][3];
      change[axis.key] = +(Math.round((axis.low + shares[i] * (axis.high - axis.low)) / step) * step).toFixed(6);
    });
    set(change);
  }

  function show() {
    const e = Scene.parameters(scene()).e;
    for (const [key, { input, range, unit, digits }] of Object.entries(inputs)) {
      const value = key === "restitution" && state.momentum ? e : state[key];
      const words = `${value.toFixed(digits)}${unit ? ` ${unit}` : ""}`;
      if (input.ariaValueText === words) continue; // nothing written, no layout
      input.value = range.from ? range.from(value) : value;
      $(`o-${key}`).textContent = words;
      input.ariaValueText = words;
    }
    inputs.restitution.input.disabled = state.momentum;
    $("momentum").checked = state.momentum;
    $("base").checked = state.base;
    for (const box of document.querySelectorAll("input[type=radio]")) box.checked = state[box.name] === box.value;
    for (const part of document.querySelectorAll("[data-when]")) {
      const [key, values] = part.dataset.when.split("=");
      const hidden = !values.split(",").includes(String(state[key]));
      if (part.hidden !== hidden) part.hidden = hidden;
    }
  }

  function set(changes) {
    if (changes.motion && changes.motion !== state.motion) [time, cells] = [0, null];
    Object.assign(state, changes);
    show();
    update();
  }

  // The sliders stand in the address: a link brings them back.
  function remember() {
    clearTimeout(remember.later);
    remember.later = setTimeout(() => {
      const parts = Object.keys(state).filter((key) => state[key] !== CARYATID[key]).map((key) => `${key}=${state[key]}`);
      history.replaceState(null, "", parts.length ? `#${parts.join("&")}` : location.pathname);
    }, 600);
  }

  function recall() {
    for (const part of location.hash.slice(1).split("&")) {
      const [key, value] = part.split("="), known = CARYATID[key];
      if (known === undefined || value === undefined) continue;
      if (typeof known === "boolean") state[key] = value === "true";
      else if (typeof known === "number") {
        const { low, high, to } = SLIDERS[key][3], ends = to ? [to(low), to(high)] : [low, high];
        if (Number.isFinite(+value)) state[key] = Math.min(Math.max(+value, ends[0]), ends[1]);
      } else if (document.querySelector(`input[name="${key}"][value="${CSS.escape(value)}"]`)) state[key] = value;
    }
  }

  build();
  recall();
  addEventListener("hashchange", () => { Object.assign(state, CARYATID); recall(); set({}); });
  set({});
  time = telling();
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (!calm) time = 0;
  play(!calm);
  return { state, set, painted: () => mapFrame !== null };
})();
