"use strict";
// Workers of a page that was opened from a file: made of its own scripts, from a Blob.
const Workers = (() => {
  // A function from a job to the promise of its result: in a worker made of this page's own scripts, else here.
  function make(samples) {
    const waiting = [];
    try {
      const code = [...document.querySelectorAll("script[data-shared]")].map((script) => script.textContent).join("\n");
      const tail = "let samples; onmessage = ({ data }) => { if (data.samples) samples = data.samples; else postMessage(Jobs.run(data, samples)); };";
      const made = new Worker(URL.createObjectURL(new Blob([code, tail], { type: "text/javascript" })));
      made.postMessage({ samples });
      made.onmessage = ({ data }) => waiting.shift()(data);
      return (job) => new Promise((done) => { waiting.push(done); made.postMessage(job); });
    } catch {
      return (job) => new Promise((done) => setTimeout(() => done(Jobs.run(job, samples))));
    }
  }

  return { make };
})();
