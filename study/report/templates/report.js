"use strict";
// Tables that sort and filter, notes at the marks of figures, legends that switch methods, and figures with a linked cursor.
const make = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};
const kept = (text) => text.trim().replace(/^(–|·|never|no limit|not judged)$/, "");
const number = (text) => {
  const found = /^[+≈≥]?\s*([-−]?[\d\s.,]*\d(?:e[-+]?\d+)?)\s*(%|s|ms|µs|ns)?(\s*\(.*\))?$/.exec(text);
  return found ? Number(found[1].replace("−", "-").replace(/[\s,]/g, "")) * ({ ms: 1e-3, "µs": 1e-6, ns: 1e-9 }[found[2]] ?? 1) : NaN;
};

// Rows move only inside their own group, so an infeasible method never rises above a feasible one; blanks stay last.
const sortable = (table, say) => {
  const heads = [...table.tHead.rows[0].cells];
  const value = (row, index) => kept(row.cells[index].dataset.value ?? row.cells[index].textContent);
  const sortBy = (head, index) => {
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of heads) if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const groups = [...table.tBodies].map((body) => [body, [...body.rows].filter((row) => !row.classList.contains("group"))]);
    const numeric = groups.every(([, rows]) => rows.every((row) => value(row, index) === "" || !isNaN(number(value(row, index)))));
    const order = (x, y) => {
      const a = value(x, index), b = value(y, index);
      if (a === "" || b === "") return (a === "") - (b === "");
      return (down ? -1 : 1) * (numeric ? number(a) - number(b) : a.localeCompare(b, "en", { numeric: true }));
    };
    for (const [body, rows] of groups) body.append(...rows.sort(order));
    say(`Sorted by ${head.textContent.trim()}, ${down ? "descending" : "ascending"}${table.querySelector("tbody.feasible") ? ", feasible methods first" : ""}.`);
  };
  heads.forEach((head, index) => {
    if (!head.hasAttribute("data-sort")) return;
    const button = make("button", { type: "button" }, ...head.childNodes);
    head.append(button);
    head.setAttribute("aria-sort", "none");
    button.addEventListener("click", () => sortBy(head, index));
  });
};

// A choice of one text, or of numbers up to one.
const choice = (name, texts) => {
  const values = [...new Set(texts)].sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
  const numeric = values.every((text) => !isNaN(number(text)));
  const select = make("select", {}, make("option", { value: "", textContent: "all" }), ...values.map((text) => make("option", { value: text, textContent: numeric ? `up to ${text}` : text })));
  const fits = (text) => !select.value || (numeric ? number(text) <= number(select.value) : text === select.value);
  return values.length < 2 ? [] : [{ select, fits, label: make("label", {}, `${name} `, select) }];
};
const choices = (table, rows) => [...table.tHead.rows[0].cells].flatMap((head, k) => {
  const value = (row) => row.cells[k].textContent.trim();
  if (!head.hasAttribute("data-choose")) return [];
  return choice(head.textContent.trim(), rows.map(value)).map((one) => ({ ...one, fits: (row) => one.fits(value(row)) }));
});

const filtered = (table, say) => {
  const bodies = [...table.tBodies], rows = bodies.flatMap((body) => [...body.rows].filter((row) => !row.classList.contains("group")));
  if (rows.length < 8) return;
  const field = make("input", { type: "search", placeholder: "words that rows must have", autocomplete: "off" });
  const chosen = choices(table, rows);
  const bar = make("div", { className: "filter" }, make("label", {}, "Filter ", field), ...chosen.map((one) => one.label));
  table.parentElement.before(bar);
  bar.addEventListener("input", () => {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    const fits = (row) => chosen.every((one) => one.fits(row)) && words.every((word) => row.textContent.toLowerCase().includes(word));
    for (const row of rows) row.hidden = !fits(row);
    for (const body of bodies) for (const row of body.querySelectorAll("tr.group")) row.hidden = rows.every((one) => one.parentElement !== body || one.hidden);
    say(rows.some((row) => row.hidden) ? `${rows.filter((row) => !row.hidden).length} of ${rows.length} rows shown.` : "");
  });
};

// A head stays in sight: at the top of the window where the table fits into the page, else at the top of a part that scrolls.
const room = new ResizeObserver((changes) => {
  for (const { target } of changes) {
    const table = target.querySelector("table");
    target.classList.toggle("fits", table.offsetWidth <= target.clientWidth);
    target.classList.toggle("tall", table.offsetHeight > 0.9 * innerHeight);
  }
});
for (const place of document.querySelectorAll(".scroll:has(> table)")) room.observe(place);

for (const table of document.querySelectorAll("table:has(th[data-sort])")) {
  const said = make("p", { className: "note" });
  said.setAttribute("role", "status");
  table.parentElement.after(said);
  const say = (text) => { said.textContent = text; };
  sortable(table, say);
  filtered(table, say);
}

// Scores of the problems that are chosen, from sums for every method and problem.
for (const place of document.querySelectorAll("script.sums")) {
  const { traits, shift, methods } = JSON.parse(place.textContent);
  const table = document.querySelector("script.sums ~ .scroll > table"), rows = [...table.tBodies[0].rows], whole = new Map(rows.map((row) => [row, [...row.cells].map((cell) => cell.textContent)]));
  const chosen = Object.entries(traits).flatMap(([name, values]) => choice(name, values).map((one) => ({ ...one, values })));
  const bar = make("div", { className: "filter" }, ...chosen.map((one) => one.label));
  place.after(bar);
  const percent = (share, sign) => { const value = 100 * share; return `${sign && value >= 0 ? "+" : ""}${value.toFixed(Math.abs(value) < 9.995 ? 2 : 1)} %`.replace("-", "−"); };
  bar.addEventListener("input", () => {
    const all = chosen.every((one) => !one.select.value);
    for (const row of rows) {
      const parts = methods[whole.get(row)[0].trim()].filter(([problem]) => chosen.every((one) => one.fits(one.values[problem])));
      const [, runs, feasible, any, own, ...near] = parts.reduce((sums, part) => sums.map((sum, k) => sum + part[k]), Array(8).fill(0));
      const gaps = [any, own].map((sum) => percent(Math.exp(sum / runs) - shift, true)), shares = near.map((sum) => percent(sum / runs, false));
      const texts = runs ? [`${feasible}/${runs}`, ...gaps, ...shares, "–", "–"] : ["0/0", ...Array(7).fill("–")];
      whole.get(row).forEach((text, k) => { if (k > 1) row.cells[k].textContent = all ? text : texts[k - 2]; });
    }
  });
}

const bubble = document.body.appendChild(make("div", { className: "bubble", hidden: true }));
bubble.setAttribute("aria-hidden", "true");
document.addEventListener("pointerover", (event) => {
  const mark = event.target.closest?.("[data-tip]");
  bubble.hidden = !mark;
  if (!mark) return;
  bubble.textContent = mark.dataset.tip;
  const left = Math.min(event.pageX + 14, scrollX + innerWidth - bubble.offsetWidth - 12);
  Object.assign(bubble.style, { left: `${Math.max(left, scrollX + 4)}px`, top: `${event.pageY + 16}px` });
});

const switches = (button, act) => {
  button.setAttribute("aria-pressed", "true");
  button.addEventListener("click", () => {
    const on = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(on));
    act(on);
  });
};
for (const legend of document.querySelectorAll(".legend:has([data-k])")) {
  const place = legend.closest("figure, section") ?? legend.parentElement;
  for (const entry of legend.querySelectorAll("[data-k]")) {
    const button = make("button", { type: "button", title: "show or hide" }, ...entry.childNodes);
    entry.append(button);
    switches(button, (on) => {
      for (const mark of place.querySelectorAll(`svg .k${entry.dataset.k}`)) mark.style.display = on ? "" : "none";
    });
  }
}

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const short = (value) => (value !== 0 && (Math.abs(value) < 1e-6 || Math.abs(value) >= 1e7) ? value.toExponential(2) : String(Number(value.toPrecision(4)))).replace("-", "−");
const shown = { percent: (value) => `${short(100 * value)} %`, plain: short };

class Figure {
  constructor(place) {
    this.spec = JSON.parse(place.querySelector("script[type='application/json']").textContent);
    this.plots = [];
    this.view = 0;
    this.off = new Set(this.spec.series.flatMap((one, k) => one.off ? [k] : []));
    this.box = make("div", { className: "plots", tabIndex: 0 });
    this.box.setAttribute("role", "group");
    this.box.setAttribute("aria-label", `${this.spec.name}: arrow keys move the cursor, a dragged stretch is enlarged, a double click shows all`);
    this.table = make("table", { className: "readout" });
    const live = make("div", { className: this.spec.columns > 1 ? "live" : "live beside" }, ...this.tabs(), make("div", { className: "scroll" }, this.table), this.box);
    place.prepend(live);
    place.classList.add("is-live");
    this.legend();
    this.draw();
    this.box.addEventListener("keydown", (event) => this.step(event));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    let wide = this.box.clientWidth;
    new ResizeObserver(() => {
      if (Math.abs(this.box.clientWidth - wide) < 2) return;
      wide = this.box.clientWidth;
      this.draw();
    }).observe(this.box);
  }

  tabs() {
    if (this.spec.views.length < 2) return [];
    const buttons = this.spec.views.map((view, k) => {
      const button = make("button", { type: "button", textContent: view.name });
      button.setAttribute("aria-pressed", String(k === 0));
      button.addEventListener("click", () => {
        this.view = k;
        buttons.forEach((one, j) => one.setAttribute("aria-pressed", String(j === k)));
        this.draw();
      });
      return button;
    });
    const row = make("div", { className: "tabs" }, ...buttons);
    row.setAttribute("role", "group");
    row.setAttribute("aria-label", this.spec.choice);
    return [row];
  }

  legend() {
    const { series, views } = this.spec;
    this.cells = series.map(() => views[0].panels.map(() => make("td", { className: "num" })));
    this.caption = make("span");
    this.table.append(make("caption", {}, this.caption),
      make("thead", {}, make("tr", {}, ...["Method", ...views[0].panels.map((panel) => panel.short)].map((text, k) => make("th", { scope: "col", className: k ? "num" : "", textContent: text })))),
      make("tbody", {}, ...series.map((one, k) => {
        const button = make("button", { type: "button", title: "show or hide" });
        button.innerHTML = `<svg viewBox="0 0 46 14" aria-hidden="true"><path d="M0 7h46" fill="none" stroke="var(--${one.color})" stroke-width="2" stroke-dasharray="${one.dash}"/></svg>`;
        button.append(one.name);
        switches(button, (on) => {
          this.off[on ? "delete" : "add"](k);
          for (const plot of this.plots) for (const at of plot.of[k]) plot.setSeries(at, { show: on });
          this.fit();
          this.read(null);
        });
        if (this.off.has(k)) button.setAttribute("aria-pressed", "false");
        const row = make("tr", {}, make("th", { scope: "row" }, button, one.note ? make("span", { className: "note", textContent: ` ${one.note}` }) : ""), ...this.cells[k]);
        row.addEventListener("pointerenter", () => this.focus(k));
        row.addEventListener("pointerleave", () => this.focus(null));
        return row;
      })));
  }

  focus(which) {
    for (const plot of this.plots) {
      this.spec.series.forEach((_, k) => { for (const at of plot.of[k]) plot.series[at].alpha = which === null || which === k ? 1 : 0.2; });
      plot.redraw(false);
    }
  }

  draw() {
    for (const plot of this.plots) plot.destroy();
    const key = uPlot.sync(`${this.spec.name}-${this.view}`);
    this.box.style.setProperty("--columns", this.spec.columns);
    const columns = this.box.clientWidth > 700 ? this.spec.columns : 1;
    const width = Math.floor((this.box.clientWidth - 18 * (columns - 1)) / columns);
    this.plots = this.spec.views[this.view].panels.map((panel) => this.plot(panel, width, key));
    this.fit();
    this.read(null);
  }

  // What runs to the right ends where the last motion shown ends.
  fit() {
    const ends = this.spec.series.flatMap((one, k) => one.end && !this.off.has(k) ? [one.end] : []);
    if (ends.length) for (const plot of this.plots) plot.setScale("x", { min: 0, max: Math.max(...ends) });
  }

  plot(panel, width, sync) {
    const { spec } = this, data = spec.x ? [spec.x, ...panel.y] : uPlot.join(panel.y);
    const of = [], series = [{}];
    spec.series.forEach((one, k) => {
      const line = { stroke: colour(one.color), width: one.thin ? 1 : 1.8, dash: one.dash.split(" ").filter(Boolean).map(Number), show: !this.off.has(k),
        points: { show: false }, spanGaps: !spec.x, paths: spec.x ? undefined : uPlot.paths.stepped({ align: 1 }) };
      of[k] = [series.push(line) - 1];
      if (spec.bands) of[k].push(...[0, 1].map(() => series.push({ ...line, width: 0, points: { show: false } }) - 1));
    });
    const axis = { stroke: colour("ink"), grid: { stroke: colour("grid"), width: 1 }, ticks: { show: false }, font: "12px system-ui, sans-serif" };
    const ranged = (log, range, room) => range ? { range: () => range } : log ? { range: (u, low, high) => [low / room, high * room] } : {};
    const scale = (log, range, room) => ({ distr: log ? 3 : 1, time: false, ...ranged(log, range, room) });
    const powers = (u, splits, steps) => splits.map((value) => steps.some((step) => Math.abs(Math.log10(value / step) - Math.round(Math.log10(value / step))) < 1e-6) ? value : null);
    const decades = (u, splits) => powers(u, splits, powers(u, splits, [1]).filter(Number).length > 1 ? [1] : [1, 2, 5]);
    const only = (log) => log ? { filter: decades, grid: { ...axis.grid, filter: decades } } : {};
    const point = (u, at) => (!spec.bands || at % 3 === 1) && make("div", { style: "width: 8px; height: 8px; margin: -4px 0 0 -4px" });
    const plot = new uPlot({
      width, height: spec.height, title: panel.title, series, legend: { show: false }, scales: { x: scale(spec.log.x, null, 1), y: scale(spec.log.y, panel.range, 1.3) },
      bands: spec.bands ? of.map(([, low, high], k) => ({ series: [high, low], fill: colour(spec.series[k].color) + "22" })) : [],
      axes: [{ ...axis, ...only(spec.log.x), size: 26, label: spec.across, labelSize: 18, labelFont: axis.font, values: (u, splits) => splits.map((value) => value === null ? "" : short(value)) },
        { ...axis, ...only(spec.log.y), size: 64, values: (u, splits) => splits.map((value) => value === null ? "" : shown[spec.form](value)) }],
      cursor: { sync: { key: sync.key }, points: { show: point }, drag: { x: true, y: false }, ...(spec.bands ? {} : { focus: { prox: 24 } }) }, focus: { alpha: 0.35 },
      hooks: { setCursor: [(u) => this.read(u)], drawAxes: [(u) => limits(u, panel)], draw: [(u) => dots(u, panel)] },
    }, data, this.box);
    plot.of = of;
    return plot;
  }

  step(event) {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    const [first] = this.plots, wide = first.over.clientWidth;
    const left = Math.min(Math.max((first.cursor.left < 0 ? 0 : first.cursor.left) + by * wide / 100, 0), wide - 1);
    for (const plot of this.plots) plot.setCursor({ left, top: 10 });
  }

  // Values under the cursor; without one the largest or the last of every line.
  read(source) {
    const at = source?.cursor.idx ?? null, x = at === null ? null : source.data[0][at];
    this.caption.textContent = at === null ? this.spec.idle : `At ${short(x)} ${this.spec.unit}:`;
    this.plots.forEach((plot, column) => this.spec.series.forEach((one, k) => {
      const values = plot.data[plot.of[k][0]];
      let value = null;
      if (at !== null && this.spec.x) value = values[at];
      else if (at !== null) { for (let j = plot.valToIdx(x); j >= 0 && value === null; j--) value = values[j] ?? null; }
      else for (const each of values) if (each !== null && each !== undefined && (value === null || !this.spec.x || Math.abs(each) > Math.abs(value))) value = each;
      this.cells[k][column].textContent = value === null || value === undefined || this.off.has(k) ? "–" : shown[this.spec.form](value);
    }));
  }
}

const limits = (u, panel) => {
  const { left, top, width, height } = u.bbox, { ctx } = u;
  ctx.save();
  for (const [value, side] of (panel.limits ?? []).map((one, k) => [one, k])) {
    if (value === null) continue;
    const y = u.valToPos(value, "y", true);
    if (y <= top || y >= top + height) continue;
    ctx.fillStyle = colour("band");
    ctx.globalAlpha = 0.5;
    ctx.fillRect(left, side ? top : y, width, side ? y - top : top + height - y);
    ctx.globalAlpha = 1;
    ctx.fillStyle = colour("ink");
    ctx.fillRect(left, y, width, devicePixelRatio);
  }
  ctx.restore();
};

const dots = (u, panel) => {
  const { ctx } = u;
  ctx.save();
  ctx.fillStyle = colour("ink");
  for (const [x, y] of panel.dots ?? []) {
    ctx.beginPath();
    ctx.arc(u.valToPos(x, "x", true), u.valToPos(y, "y", true), 3.2 * devicePixelRatio, 0, 7);
    ctx.fill();
  }
  ctx.restore();
};

if (window.uPlot) for (const place of document.querySelectorAll("figure:has(> script[type='application/json'])")) place.figure = new Figure(place);
