"use strict";
// Values under the pointer, lines that can be hidden, tables that sort, files to save. Everything is on the page itself.
(() => {
  const told = document.getElementById("told");
  const tell = (words, x, y) => {
    told.hidden = !words;
    if (!words) return;
    told.textContent = words;
    const width = Math.min(told.offsetWidth, innerWidth - 16);
    told.style.left = Math.max(8, Math.min(x + 12, innerWidth - width - 8)) + "px";
    told.style.top = (y > 60 ? y - 36 : y + 18) + "px";
  };
  const value = (axis, place) => {
    const share = (place - axis.at[0]) / (axis.at[1] - axis.at[0]);
    return axis.log ? axis.low * (axis.high / axis.low) ** share : axis.low + share * (axis.high - axis.low);
  };
  const short = (x) => String(+x.toPrecision(3)).replace("-", "−");

  // The nearest point of a line, read back from its path.
  const nearest = (chart, x, y) => {
    let best = null;
    for (const line of chart.querySelectorAll(".who:not([hidden]) .line")) {
      line.points ??= line.getAttribute("d").slice(1).split(/[ML]/).map((pair) => pair.split(" ").map(Number));
      for (const [a, b] of line.points) {
        const far = Math.hypot(a - x, b - y);
        if (!best || far < best.far) best = { far, a, b, who: line.parentNode.dataset.who };
      }
    }
    return best && best.far < 22 ? best : null;
  };
  document.addEventListener("pointermove", (event) => {
    const chart = event.target.closest?.(".chart[data-read]");
    if (!chart) return tell("");
    const says = event.target.dataset?.says;
    if (says) return tell(says, event.clientX, event.clientY);
    const box = chart.getBoundingClientRect(), scale = chart.viewBox.baseVal.width / box.width;
    const found = nearest(chart, (event.clientX - box.left) * scale, (event.clientY - box.top) * scale);
    if (!found) return tell("");
    const read = JSON.parse(chart.dataset.read);
    tell(`${found.who ?? ""}  ${read.x.label}: ${short(value(read.x, found.a))}, ${read.y.label}: ${short(value(read.y, found.b))}`, event.clientX, event.clientY);
  });
  document.addEventListener("scroll", () => tell(""), { passive: true });

  // A click on a solver's key hides it in the figures beside the key.
  for (const key of document.querySelectorAll("button[data-hides]")) {
    key.addEventListener("click", () => {
      const shown = key.getAttribute("aria-pressed") !== "true";
      key.setAttribute("aria-pressed", shown);
      for (const group of key.closest("figure, .stage").querySelectorAll(`[data-who="${CSS.escape(key.dataset.hides)}"]`)) {
        if (!group.closest("button")) group.toggleAttribute("hidden", !shown), (group.style.display = shown ? "" : "none");
      }
    });
  }

  // Tables: a click on a head sorts, by number where cells begin with one.
  const superscripts = { "⁻": "-", "⁰": 0, "¹": 1, "²": 2, "³": 3, "⁴": 4, "⁵": 5, "⁶": 6, "⁷": 7, "⁸": 8, "⁹": 9 };
  const number = (words) => {
    const found = words.replace(/−/g, "-").match(/^[^\d-]{0,2}(-?[\d.]+)(?:·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?/);
    return found ? +found[1] * 10 ** +([...(found[2] ?? "")].map((sign) => superscripts[sign]).join("") || 0) : NaN;
  };
  for (const table of document.querySelectorAll("table")) {
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      const button = document.createElement("button");
      button.append(...head.childNodes);
      button.title = "sort";
      head.append(button);
      button.addEventListener("click", () => {
        const down = head.getAttribute("aria-sort") === "ascending", rows = [...table.tBodies[0].rows];
        for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", down ? "descending" : "ascending");
        const cell = (row) => row.cells[column].textContent.trim();
        const order = (a, b) => {
          const [u, v] = [number(cell(a)), number(cell(b))];
          if (isNaN(u) || isNaN(v)) return isNaN(u) && isNaN(v) ? cell(a).localeCompare(cell(b)) : isNaN(u) ? 1 : -1;
          return u - v;
        };
        rows.sort((a, b) => (down ? -1 : 1) * order(a, b));
        table.tBodies[0].append(...rows);
      });
    });
  }

  // Files: a table as CSV, a figure as SVG with its colours resolved.
  const save = (name, type, text) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const csv = (table) => [...table.rows].map((row) => [...row.cells].map((cell) => `"${cell.textContent.trim().replace(/\s+/g, " ").replaceAll('"', '""')}"`).join(",")).join("\r\n");
  const KEPT = ["fill", "stroke", "stroke-width", "stroke-dasharray", "font", "text-anchor", "opacity", "display"];
  const drawn = (svg) => {
    const copy = svg.cloneNode(true), [from, to] = [svg, copy].map((one) => [one, ...one.querySelectorAll("*")]);
    from.forEach((part, k) => { const style = getComputedStyle(part); for (const key of KEPT) to[k].style.setProperty(key, style.getPropertyValue(key)); });
    copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    copy.style.background = getComputedStyle(document.body).backgroundColor;
    return new XMLSerializer().serializeToString(copy);
  };
  document.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    const file = (document.title + "-" + (button.closest("section")?.id ?? "part")).toLowerCase().replace(/[^a-z0-9]+/g, "-").slice(0, 60);
    if (button.dataset.saves === "csv") save(file + ".csv", "text/csv", csv(button.closest(".table").querySelector("table")));
    if (button.dataset.saves === "svg") button.closest("figure").querySelectorAll("svg.chart:not(.mini), svg.drawn").forEach((svg, k) => save(`${file}-${k + 1}.svg`, "image/svg+xml", drawn(svg)));
    if (button.dataset.more !== undefined) { const all = button.closest(".table").querySelector("table").classList.toggle("all"); button.setAttribute("aria-expanded", all); button.textContent = all ? "fewer rows" : button.dataset.more; }
    if (button.dataset.copies) navigator.clipboard?.writeText(button.dataset.copies).then(() => { button.textContent = "copied"; });
  });
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((one) => { one.wasOpen = one.open; one.open = true; }));
  addEventListener("afterprint", () => document.querySelectorAll("details").forEach((one) => { one.open = one.wasOpen; }));
})();
