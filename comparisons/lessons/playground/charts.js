"use strict";
// Charts on canvases, in the page's own colours.
const Charts = (() => {
  const styles = getComputedStyle(document.documentElement);
  const colour = (name) => styles.getPropertyValue(`--${name}`).trim();
  const NEAR = 0.8; // pixels: points of a curve that are closer are left out
  const FONT = '12px system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

  // [context, width, height] in CSS pixels, cleared; the canvas follows its box and the screen's density.
  function fresh(canvas) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2), width = canvas.clientWidth, height = canvas.clientHeight;
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.font = FONT;
    context.lineJoin = "round";
    return [context, width, height];
  }

  function ticks(low, high, about) {
    const raw = (high - low) / about, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 2.5, 5, 10].map((f) => f * power).find((s) => s >= raw * 0.999), found = [];
    for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) found.push(Math.abs(v) < 1e-9 * step ? 0 : v);
    return found;
  }

  const text = (value) => String(+value.toPrecision(3)).replace("-", "−");

  // Smallest of the given limits that contains the value, so that axes do not change continuously with a slider.
  function limit(value, limits) {
    return limits.find((top) => value <= top) ?? limits[limits.length - 1];
  }

  // Frame with ticks and labels; returns { x, y, context, box } with the scales as functions.
  function axes(canvas, { x: [x0, x1], y: [y0, y1], xLabel, yLabel, grid = true, left = 58 }) {
    const [context, width, height] = fresh(canvas), box = { left, right: width - 10, top: 10, bottom: height - 36 };
    const x = (v) => box.left + ((v - x0) / (x1 - x0)) * (box.right - box.left);
    const y = (v) => box.bottom - ((v - y0) / (y1 - y0)) * (box.bottom - box.top);
    context.lineWidth = 1;
    context.textBaseline = "middle";
    for (const v of ticks(x0, x1, (box.right - box.left) / 75)) {
      if (grid) line(context, x(v), box.top, x(v), box.bottom, colour("grid"));
      context.fillStyle = colour("soft");
      context.textAlign = "center";
      context.fillText(text(v), x(v), box.bottom + 11);
    }
    for (const v of ticks(y0, y1, (box.bottom - box.top) / 36)) {
      if (grid) line(context, box.left, y(v), box.right, y(v), colour(v === 0 ? "axis" : "grid"));
      context.fillStyle = colour("soft");
      context.textAlign = "right";
      context.fillText(text(v), box.left - 6, y(v));
    }
    context.textAlign = "center";
    context.fillText(xLabel, (box.left + box.right) / 2, height - 9);
    context.save();
    context.translate(9, (box.top + box.bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.fillText(yLabel, 0, 0);
    context.restore();
    return { x, y, context, box };
  }

  function line(context, x0, y0, x1, y1, stroke) {
    context.strokeStyle = stroke;
    context.beginPath();
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    context.stroke();
  }

  // A curve through points [[x, y], ...] of the data, kept inside the frame.
  function curve({ x, y, context, box }, rows, across, up, { stroke, width = 1.8, dash = [] }) {
    context.save();
    context.beginPath();
    context.rect(box.left, box.top - 1, box.right - box.left, box.bottom - box.top + 2);
    context.clip();
    context.beginPath();
    let [lastX, lastY] = [Infinity, Infinity];
    for (let i = 0; i < rows.length; i++) {
      const px = x(across(rows[i])), py = y(up(rows[i]));
      if (Math.abs(px - lastX) + Math.abs(py - lastY) < NEAR && i < rows.length - 1) continue; // not visible
      if (i) context.lineTo(px, py);
      else context.moveTo(px, py);
      [lastX, lastY] = [px, py];
    }
    context.strokeStyle = stroke;
    context.lineWidth = width;
    context.setLineDash(dash);
    context.stroke();
    context.restore();
  }

  function dot({ x, y, context, box }, across, up, fill) {
    const [px, py] = [Math.min(Math.max(x(across), box.left), box.right), Math.min(Math.max(y(up), box.top), box.bottom)];
    context.beginPath();
    context.arc(px, py, 4.5, 0, 7);
    context.fillStyle = fill;
    context.fill();
    context.strokeStyle = colour("panel");
    context.lineWidth = 1.5;
    context.stroke();
  }

  function note({ context, box }, words) {
    context.fillStyle = colour("soft");
    context.textAlign = "center";
    context.fillText(words, (box.left + box.right) / 2, box.top + 0.3 * (box.bottom - box.top));
  }

  // State [t, tilt, rate, x, v, F] at time t; rows by time.
  function at(rows, t) {
    let low = 0, high = rows.length - 1;
    if (high < 0) return [t, 0, 0, 0, 0, 0];
    if (t >= rows[high][0]) return rows[high];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (rows[middle][0] <= t) low = middle;
      else high = middle;
    }
    const [a, b] = [rows[low], rows[high]], u = b[0] > a[0] ? (t - a[0]) / (b[0] - a[0]) : 0;
    return a.map((value, k) => value + u * (b[k] - value));
  }

  // to([x, y]): where the canvas is touched, in its pixels, and on while the pointer is held down.
  function drag(canvas, to) {
    const tell = (event) => {
      const box = canvas.getBoundingClientRect();
      to([event.clientX - box.left, event.clientY - box.top]);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      tell(event);
    });
    canvas.addEventListener("pointermove", (event) => canvas.hasPointerCapture(event.pointerId) && tell(event));
  }

  return { fresh, axes, curve, dot, note, line, at, limit, drag, colour, FONT };
})();
