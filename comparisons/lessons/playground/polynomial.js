"use strict";
// Values and first roots of the Taylor polynomials of a step: analytic/kernel/polynomial.py in JavaScript.
// A polynomial is an array of coefficients, lowest first; `order` is the highest power used.
const Polynomial = (() => {
  const MAX_ORDER = 24, BISECTIONS = 60;
  const stack = Array.from({ length: BISECTIONS + 2 }, () => new Float64Array(MAX_ORDER + 1));
  const starts = new Float64Array(BISECTIONS + 2), widths = new Float64Array(BISECTIONS + 2);

  function value(f, order, t) {
    let total = f[order];
    for (let k = order - 1; k >= 0; k--) total = total * t + f[k];
    return total;
  }

  // Root of f(t)/t^first in (low, high], where it falls from + to -: Newton from the far end, kept in the bracket.
  function bracketedRoot(f, first, order, low, high) {
    let t = high;
    for (let i = 0; i < BISECTIONS; i++) {
      let total = f[order], slope = 0;
      for (let k = order - 1; k >= first; k--) {
        slope = slope * t + total;
        total = total * t + f[k];
      }
      if (total > 0) low = t;
      else if (total < 0) high = t;
      else return t;
      const step = slope < 0 ? total / slope : 0;
      let next = t - step;
      if (slope >= 0 || next <= low || next >= high) {
        if (slope < 0 && Math.abs(step) <= 4e-16 * t) return t; // converged to the bracket itself
        next = 0.5 * (low + high);
      }
      if (Math.abs(next - t) <= 2e-16 * t) return next;
      t = next;
    }
    return t;
  }

  // First t in [0, h] where f falls below 0, or -1. Leading zeros are a root at 0 and are divided out; Bernstein
  // coefficients bound the polynomial, so no crossing is missed.
  function firstRoot(f, order, h) {
    let first = 0;
    while (first <= order && f[first] === 0) first++;
    if (first > order) return -1;
    if (f[first] < 0) return 0;
    let lowest = f[first], power = 1;
    for (let k = first + 1; k <= order; k++) {
      power *= h;
      if (f[k] < 0) lowest += f[k] * power;
    }
    if (lowest > 0) return -1;
    let steepest = 0, end = f[order];
    power = 1;
    for (let k = first + 1; k <= order; k++) {
      if (k === first + 1 || f[k] > 0) steepest += (k - first) * f[k] * power;
      power *= h;
    }
    for (let k = order - 1; k >= first; k--) end = end * h + f[k];
    if (steepest < 0) return end < 0 ? bracketedRoot(f, first, order, 0, h) : -1; // falls all the way
    return isolatedRoot(f, first, order, h);
  }

  function isolatedRoot(f, first, order, h) {
    const n = order - first, b0 = stack[0];
    for (let k = 0, power = 1, binomial = 1; k <= n; k++) {
      b0[k] = (f[first + k] * power) / binomial;
      power *= h;
      binomial *= (n - k) / (k + 1);
    }
    for (let j = 1; j <= n; j++) for (let i = n; i >= j; i--) b0[i] += b0[i - 1];
    starts[0] = 0;
    widths[0] = h;
    let top = 0;
    while (top >= 0) {
      const low = starts[top], width = widths[top], b = stack[top];
      let sign = 0, changes = 0;
      for (let i = 0; i <= n; i++) {
        if (b[i] === 0) continue;
        const now = b[i] > 0 ? 1 : -1;
        if (sign === 0 && now < 0) return low;
        if (sign !== 0 && now !== sign) changes++;
        sign = now;
      }
      if (changes === 1) return bracketedRoot(f, first, order, low, low + width);
      if (changes === 0 || top >= BISECTIONS) {
        top--;
        continue;
      }
      const left = stack[top + 1]; // de Casteljau at the middle
      for (let i = 0; i <= n; i++) {
        left[i] = b[0];
        for (let j = 0; j < n - i; j++) b[j] = 0.5 * (b[j] + b[j + 1]);
      }
      starts[top] = low + 0.5 * width;
      widths[top] = widths[top + 1] = 0.5 * width;
      starts[top + 1] = low;
      top++;
    }
    return -1;
  }

  return { MAX_ORDER, value, bracketedRoot, firstRoot };
})();
