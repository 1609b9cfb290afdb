"use strict";
// A lesson's picture follows its controls: each place has a picture and its numbers, made when the page was written.
(() => {
  const controls = [...document.querySelectorAll(".control")].map((box) => [...box.querySelectorAll("[data-control]")]);
  const sizes = controls.map((inputs) => (inputs[0].type === "radio" ? inputs.length : +inputs[0].max + 1));
  const texts = JSON.parse(document.querySelector("[data-texts]").dataset.texts);
  const at = (inputs) => +(inputs[0].type === "radio" ? inputs.find((input) => input.checked) : inputs[0]).value;

  function show() {
    const places = controls.map(at);
    const place = places.reduce((sum, value, k) => sum * sizes[k] + value, 0);
    const parts = document.querySelector(`template[data-place="${place}"]`), copy = parts.content.cloneNode(true);
    document.getElementById("picture").replaceChildren(copy.querySelector("svg"));
    document.getElementById("picture").setAttribute("aria-label", parts.dataset.says);
    document.getElementById("numbers").replaceChildren(...copy.querySelector("dl").children);
    places.forEach((value, k) => {
      const output = document.getElementById(`o-${k}`);
      if (!output) return;
      output.textContent = texts[k][value];
      controls[k][0].setAttribute("aria-valuetext", texts[k][value]);
    });
    clearTimeout(show.later);
    show.later = setTimeout(() => (document.getElementById("says").textContent = parts.dataset.says), 500);
  }

  for (const inputs of controls) for (const input of inputs) input.addEventListener("input", show);
  show();
})();
