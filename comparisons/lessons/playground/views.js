"use strict";
// The views: the block itself, tilt over time, phase plane, loop of the bearings, overturning map.
const Views = (() => {
  const { colour, curve, dot } = Charts;
  const GHOST_DASH = [5, 4], WHOLE = 1.5; // of the tilt axis, over slenderness
  const CELLS = ["stands", "rocks", "at-once", "after-impacts", "open"];

  const clipped = (rows, gamma) => {
    const end = rows.findIndex((row) => Math.abs(row[1]) > 1.2 * WHOLE * gamma);
    return end < 0 ? rows : rows.slice(0, end + 1);
  };

  // --- the block ------------------------------------------------------------------------------------------------

  function outline(context, par, state, place) {
    const b = par.R * Math.sin(par.gamma), h = par.R * Math.cos(par.gamma), s = Math.sign(state[1]);
    const turn = (u, w) => { // about the corner it stands on
      const dx = u - s * b, c = Math.cos(state[1]), n = Math.sin(state[1]);
      return place(state[3] + s * b + c * dx + n * w, -n * dx + c * w);
    };
    context.beginPath();
    for (const [u, w] of [[-b, 0], [b, 0], [b, 2 * h], [-b, 2 * h]]) context.lineTo(...turn(u, w));
    context.closePath();
    return { centre: turn(0, h), corner: place(state[3] + s * b, 0) };
  }

  function block(canvas, { par, state, ghost, ground }) {
    const [context, width, height] = Charts.fresh(canvas);
    const b = par.R * Math.sin(par.gamma), h = par.R * Math.cos(par.gamma), floor = height - 26;
    const slab = par.onBase ? 14 : 0, rubber = par.onBase ? 26 : 0;
    const reach = 2 * par.R + (par.onBase ? 0.35 : 0.1) * par.R; // tallest and widest it gets
    const scale = Math.min((floor - slab - rubber - 12) / (2.06 * par.R), (width - 24) / (2 * reach));
    const place = (X, Y) => [width / 2 + X * scale, floor - slab - rubber - Y * scale];
    context.fillStyle = colour("ground");
    context.fillRect(0, floor, width, 7);
    Charts.line(context, 0, floor, width, floor, colour("ink"));
    if (par.onBase) drawBase(context, { width, floor, slab, rubber, scale, b, x: state[3] });
    const drawn = outline(context, par, state, place);
    context.fillStyle = colour("stone");
    context.fill();
    context.strokeStyle = colour("ink");
    context.lineWidth = 1.6;
    context.stroke();
    context.setLineDash([2, 3]);
    context.lineWidth = 1;
    if (state[1]) Charts.line(context, ...drawn.corner, ...drawn.centre, colour("soft"));
    context.setLineDash([]);
    spot(context, drawn.centre, colour("ink"), 3);
    if (state[1]) spot(context, drawn.corner, colour("model"), 4.5);
    if (ghost) {
      outline(context, par, ghost, place);
      context.strokeStyle = colour("ghost");
      context.setLineDash(GHOST_DASH);
      context.lineWidth = 2;
      context.stroke();
      context.setLineDash([]);
    }
    arrow(context, width / 2, floor + 16, ground);
  }

  function spot(context, [x, y], fill, radius) {
    context.beginPath();
    context.arc(x, y, radius, 0, 7);
    context.fillStyle = fill;
    context.fill();
  }

  function drawBase(context, { width, floor, slab, rubber, scale, b, x }) {
    const half = b * scale + 34, middle = width / 2, top = floor - rubber, shift = x * scale;
    for (const side of [-0.68, 0.68]) {
      for (let layer = 0; layer < 5; layer++) { // sheared, layer by layer
        const u = (layer + 0.5) / 5, left = middle + side * half - 14 + shift * u;
        context.fillStyle = colour(layer % 2 ? "steel" : "rubber");
        context.fillRect(left, floor - ((layer + 1) * rubber) / 5, 28, rubber / 5 - 0.5);
      }
    }
    context.fillStyle = colour("steel");
    context.fillRect(middle - half + shift, top - slab, 2 * half, slab);
    context.strokeStyle = colour("ink");
    context.lineWidth = 1.2;
    context.strokeRect(middle - half + shift, top - slab, 2 * half, slab);
  }

  // Of the ground acceleration, as long as it is strong.
  function arrow(context, x, y, share) {
    const words = x < 150 ? "ground" : "ground acceleration";
    const length = Math.max(-1, Math.min(1, share)) * Math.min(90, x - context.measureText(words).width - 14);
    context.fillStyle = colour("soft");
    context.textAlign = "left";
    context.textBaseline = "middle";
    if (Math.abs(length) < 2) return;
    const tip = x + length, back = tip - Math.sign(length) * Math.min(8, Math.abs(length));
    context.lineWidth = 3;
    Charts.line(context, x, y, back, y, colour("soft"));
    context.beginPath();
    context.moveTo(tip, y);
    context.lineTo(back, y - 5);
    context.lineTo(back, y + 5);
    context.fill();
    context.fillText(words, length > 0 ? Math.max(tip, x) + 8 : x + 8, y);
  }

  // --- charts ---------------------------------------------------------------------------------------------------

  function tilt(canvas, { par, run, ghost, window, ground, t }) {
    const g = par.gamma, largest = Math.max(run.shown, ghost ? ghost.shown : 0) / g;
    const top = Charts.limit(largest * 1.05, [0.02, 0.05, 0.1, 0.25, 0.5, 1.1, WHOLE]);
    const frame = Charts.axes(canvas, { x: [0, window], y: [-top, top], xLabel: "time [s]", yLabel: "tilt / slenderness [–]" });
    shaking(frame, ground, window);
    if (top > 1) {
      frame.context.setLineDash([3, 4]);
      for (const side of [-1, 1]) Charts.line(frame.context, frame.box.left, frame.y(side), frame.box.right, frame.y(side), colour("soft"));
      frame.context.setLineDash([]);
    }
    curve(frame, run.rows, (row) => row[0], (row) => row[1] / g, { stroke: colour("model"), width: 2.2 });
    if (ghost) curve(frame, ghost.rows, (row) => row[0], (row) => row[1] / g, { stroke: colour("ghost"), dash: GHOST_DASH });
    const x = frame.x(Math.min(t, window));
    frame.context.lineWidth = 1;
    Charts.line(frame.context, x, frame.box.top, x, frame.box.bottom, colour("ink"));
    dot(frame, Math.min(t, window), Charts.at(run.rows, t)[1] / g, colour("model"));
    return frame;
  }

  // The ground acceleration faintly behind the tilt, to its own scale.
  function shaking(frame, ground, window) {
    if (!ground.scale) return;
    const peak = ground.peak, rows = [], count = frame.box.right - frame.box.left;
    for (let i = 0; i <= count; i++) {
      const time = (i / count) * window;
      rows.push([time, Scene.acceleration(ground, time) / peak]);
    }
    const y = (v) => (frame.box.top + frame.box.bottom) / 2 - v * 0.42 * (frame.box.bottom - frame.box.top);
    curve({ ...frame, y }, rows, (row) => row[0], (row) => row[1], { stroke: colour("shaking"), width: 1.2 });
  }

  function phase(canvas, { par, run, ghost, t }) {
    const g = par.gamma, p = Math.sqrt(par.p2);
    const shown = clipped(run.rows, g), other = ghost ? clipped(ghost.rows, g) : [];
    const fastest = [...shown, ...other].reduce((most, row) => Math.max(most, Math.abs(row[2])), 0) / (p * g);
    const widest = [...shown, ...other].reduce((most, row) => Math.max(most, Math.abs(row[1])), 0) / g;
    const limits = [0.02, 0.05, 0.1, 0.25, 0.5, 1.1, WHOLE, 2.5];
    const [xTop, yTop] = [Charts.limit(widest * 1.05, limits.slice(0, 7)), Charts.limit(fastest * 1.05, limits)];
    const frame = Charts.axes(canvas, { x: [-xTop, xTop], y: [-yTop, yTop], xLabel: "tilt / slenderness [–]", yLabel: "rate / (ωᵣ γ) [–]" });
    Charts.line(frame.context, frame.x(0), frame.box.top, frame.x(0), frame.box.bottom, colour("axis"));
    curve(frame, shown, (row) => row[1] / g, (row) => row[2] / (p * g), { stroke: colour("model"), width: 1.8 });
    if (ghost) curve(frame, other, (row) => row[1] / g, (row) => row[2] / (p * g), { stroke: colour("ghost"), width: 1.4, dash: GHOST_DASH });
    if (!run.uplifts.length && !par.tilt) Charts.note(frame, "the block does not lift");
    const state = Charts.at(run.rows, t);
    if (Math.abs(state[1]) <= xTop * g) dot(frame, state[1] / g, state[2] / (p * g), colour("model"));
  }

  function loop(canvas, { run, ghost, t }) {
    const of = (k) => run.rows.reduce((most, row) => Math.max(most, Math.abs(row[k])), 0);
    const limits = [0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];
    const [xTop, yTop] = [Charts.limit(of(3) * 1.05, limits), Charts.limit((of(5) / 1e3) * 1.05, limits)];
    const frame = Charts.axes(canvas, { x: [-xTop, xTop], y: [-yTop, yTop], xLabel: "base displacement [m]", yLabel: "force of all bearings [kN]" });
    Charts.line(frame.context, frame.x(0), frame.box.top, frame.x(0), frame.box.bottom, colour("axis"));
    curve(frame, run.rows, (row) => row[3], (row) => row[5] / 1e3, { stroke: colour("model"), width: 1.6 });
    if (ghost) curve(frame, ghost.rows, (row) => row[3], (row) => row[5] / 1e3, { stroke: colour("ghost"), width: 1.2, dash: GHOST_DASH });
    const state = Charts.at(run.rows, t);
    dot(frame, state[3], state[5] / 1e3, colour("model"));
  }

  // cells: { nx, ny, values: Uint8Array }; the place of the sliders is a ring.
  function map(canvas, { cells, axes: [across, up], place }) {
    const frame = Charts.axes(canvas, {
      x: [across.low, across.high], y: [up.low, up.high], xLabel: across.label, yLabel: up.label, grid: false,
    });
    const { context, box, x, y } = frame;
    if (cells) {
      context.imageSmoothingEnabled = false;
      context.drawImage(picture(cells), box.left, box.top, box.right - box.left, box.bottom - box.top);
    }
    context.strokeStyle = colour("axis");
    context.strokeRect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    const [px, py] = [x(place[0]), y(place[1])];
    for (const [stroke, width] of [[colour("panel"), 5], [colour("ink"), 2]]) {
      context.strokeStyle = stroke;
      context.lineWidth = width;
      context.beginPath();
      context.arc(px, py, 7, 0, 7);
      context.stroke();
    }
    return frame;
  }

  // The cells as an image, a pixel each; kept until cells or colours change.
  let kept = { cells: null, colours: "", canvas: null };
  function picture(cells) {
    const { nx, ny, values } = cells, fills = CELLS.map(colour), colours = fills.join();
    if (kept.cells === cells && kept.colours === colours) return kept.canvas;
    const canvas = document.createElement("canvas"), context = canvas.getContext("2d");
    [canvas.width, canvas.height] = [nx, ny];
    const image = context.createImageData(nx, ny), parts = fills.map((hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16)));
    for (let k = 0; k < nx * ny; k++) {
      const pixel = 4 * ((ny - 1 - Math.floor(k / nx)) * nx + (k % nx));
      image.data.set(parts[values[k]], pixel);
      image.data[pixel + 3] = 255;
    }
    context.putImageData(image, 0, 0);
    kept = { cells, colours, canvas };
    return canvas;
  }

  return { block, tilt, phase, loop, map };
})();
