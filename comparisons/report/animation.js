"use strict";
// The scene in all solvers on one clock: blocks turn about the corner they rest on and slide on their bases, which move on bearings.
(() => {
  const stage = document.getElementById("stage");
  if (!stage) return;
  const data = JSON.parse(document.getElementById("histories").textContent);
  const slider = stage.querySelector("input"), play = stage.querySelector("button[data-plays]"), output = stage.querySelector("output");
  const cursor = stage.querySelector(".trace line");
  const at = (values, frame) => {
    const k = Math.min(Math.floor(frame), values.length - 1), next = Math.min(k + 1, values.length - 1);
    return values[k] + (values[next] - values[k]) * Math.min(frame - Math.floor(frame), 1);
  };
  const pose = (time) => {
    const frame = time / data.step;
    data.scenes.forEach((scene, k) => {
      const svg = stage.querySelector(`svg[data-scene="${k}"]`);
      scene.tracks.forEach((track, which) => {
        const tilt = at(track.tilt, frame), x = track.x ? at(track.x, frame) : 0, b = scene.size[0];
        const slip = track.slip ? at(track.slip, frame) : 0;
        svg.querySelector(`[data-track="${which}"]`).setAttribute("transform", `translate(${(x + slip).toFixed(4)} 0) rotate(${((tilt * 180) / Math.PI).toFixed(3)} ${tilt < 0 ? -b : b} 0)`);
        if (which === 0 && scene.base) {
          svg.querySelectorAll(".moves").forEach((one) => one.setAttribute("transform", `translate(${x.toFixed(4)} 0)`));
          svg.querySelectorAll(".shears").forEach((one) => one.setAttribute("transform", `translate(${one.dataset.at} .36) skewX(${((-Math.atan2(x, 0.2) * 180) / Math.PI).toFixed(3)})`));
        }
      });
    });
    output.textContent = time.toFixed(2) + " s";
    slider.setAttribute("aria-valuetext", time.toFixed(2) + " seconds");
    cursor?.setAttribute("x1", frame);
    cursor?.setAttribute("x2", frame);
  };
  let running = false, began = 0;
  const end = (data.count - 1) * data.step;
  const tick = (now) => {
    if (!running) return;
    const time = (now - began) / 1000;
    slider.value = Math.min(time, end);
    pose(+slider.value);
    if (time > end + 1) began = now;
    requestAnimationFrame(tick);
  };
  const set = (on) => {
    running = on;
    play.textContent = on ? "Pause" : "Play";
    if (on) { began = performance.now() - 1000 * (+slider.value >= end ? 0 : +slider.value); requestAnimationFrame(tick); }
  };
  play.addEventListener("click", () => set(!running));
  slider.addEventListener("input", () => { set(false); pose(+slider.value); });
  pose(+slider.value);
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) new IntersectionObserver((seen, watch) => { if (seen[0].isIntersecting) { watch.disconnect(); set(true); } }).observe(stage);
})();
