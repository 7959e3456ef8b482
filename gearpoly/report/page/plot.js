// One zoomable plot: a canvas with axes, a view in its own units, and a read-out at the crosshair.

import { clamp, TURN } from "../../page/kit/data.js";
import { Chart, ticks, tickText } from "../../page/kit/charts.js";
import { hands } from "./hands.js";

export const ROOM = { left: 62, right: 12, top: 10, bottom: 38 };

export class Plot {
  // options: title (for screen readers), home() -> [x0, x1, y0, y1], least [dx, dy] of the closest view,
  // paint(plot), read(plot, x, y) -> {text, x} or null, xLabel, yLabel, xTicks, yTicks, log, both (zoom of both axes),
  // step(plot, x, sign) -> the next place of the read-out.
  constructor(figure, options) {
    this.figure = figure;
    this.options = options;
    this.room = ROOM;
    this.rekey = () => this.refresh(); // where the key of its colours changes with them
    this.bench = figure.appendChild(document.createElement("div"));
    this.bench.className = "bench";
    const canvas = figure.appendChild(document.createElement("canvas"));
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", options.title);
    this.out = figure.appendChild(document.createElement("output"));
    this.out.className = "read";
    this.chart = new Chart(canvas);
    this.friends = [];
    this.cross = null;
    this.button("+", "Zoom in", () => this.zoom(0.5, this.options.both ? 0.5 : 1), "push");
    this.button("\u2212", "Zoom out", () => this.zoom(2, this.options.both ? 2 : 1));
    if (!options.both) this.button("fit height", "Fit the height to what is shown", () => this.fitHeight());
    this.button("everything", "Show everything", () => this.reset());
    hands(this);
    new ResizeObserver(() => this.refresh()).observe(canvas);
    this.reset();
  }

  button(text, title, act, name = "") {
    const one = this.bench.appendChild(document.createElement("button"));
    one.type = "button";
    one.textContent = text;
    one.title = title;
    one.setAttribute("aria-label", `${title}: ${this.options.title}`);
    one.className = name;
    one.addEventListener("click", act);
    return one;
  }

  get inner() {
    return {
      width: Math.max(1, (this.chart.width ?? 1) - ROOM.left - ROOM.right),
      height: Math.max(1, (this.chart.height ?? 1) - ROOM.top - ROOM.bottom),
    };
  }

  // Places on a logarithmic axis are the logarithms of the values.
  height(y) { return this.options.log ? Math.log10(Math.max(y, 1e-12)) : y; }
  px(x) { return ROOM.left + ((x - this.view.x0) / (this.view.x1 - this.view.x0)) * this.inner.width; }
  py(y) { return ROOM.top + ((this.view.y1 - this.height(y)) / (this.view.y1 - this.view.y0)) * this.inner.height; }
  x(px) { return this.view.x0 + ((px - ROOM.left) / this.inner.width) * (this.view.x1 - this.view.x0); }
  y(py) {
    const v = this.view.y1 - ((py - ROOM.top) / this.inner.height) * (this.view.y1 - this.view.y0);
    return this.options.log ? 10 ** v : v;
  }

  // True where the view is everything there is.
  get whole() {
    const v = this.view, h = this.home;
    const full = 1 - 1e-9; // views are sums, which round
    return v.x1 - v.x0 >= full * (h.x1 - h.x0) && v.y1 - v.y0 >= full * (h.y1 - h.y0);
  }

  reset() {
    const [x0, x1, y0, y1] = this.options.home();
    this.home = { x0, x1, y0, y1 };
    this.show({ ...this.home });
  }

  // Zoom by factors about a place, by default the middle; a factor below 1 shows less.
  zoom(fx, fy, x = 0.5 * (this.view.x0 + this.view.x1), v = 0.5 * (this.view.y0 + this.view.y1)) {
    const { x0, x1, y0, y1 } = this.view;
    const [dx, dy] = this.options.least;
    const kx = Math.max(fx, dx / (x1 - x0)), ky = Math.max(fy, dy / (y1 - y0));
    this.show({ x0: x + (x0 - x) * kx, x1: x + (x1 - x) * kx, y0: v + (y0 - v) * ky, y1: v + (y1 - v) * ky });
  }

  // Move by shares of the view.
  pan(sx, sy) {
    const { x0, x1, y0, y1 } = this.view;
    const dx = sx * (x1 - x0), dy = sy * (y1 - y0);
    this.show({ x0: x0 + dx, x1: x1 + dx, y0: y0 + dy, y1: y1 + dy });
  }

  fitHeight() {
    const fitted = this.options.fitted?.(this, this.view.x0, this.view.x1);
    if (fitted) this.show({ ...this.view, y0: fitted[0], y1: fitted[1] });
  }

  // A view kept within what there is; friends share its x axis.
  show(view, alone = false) {
    const h = this.home;
    const [x0, x1] = within(view.x0, view.x1, h.x0, h.x1);
    const [y0, y1] = within(view.y0, view.y1, h.y0, h.y1);
    this.view = { x0, x1, y0, y1 };
    if (!alone) for (const one of this.friends) one.show({ ...one.view, x0, x1 }, true);
    this.refresh();
  }

  // The read-out at x, y in the plot's units, or none; friends show theirs at the same x.
  point(x, y, alone = false) {
    this.cross = x === null ? null : { x, y };
    const read = this.cross && this.options.read(this, x, y);
    if (this.cross && read) this.cross.x = read.x ?? x;
    this.out.textContent = read ? read.text : "";
    if (!alone) for (const one of this.friends) one.point(x, null, true);
    this.refresh();
  }

  refresh() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  draw() {
    const { chart, view, options } = this;
    chart.fit();
    if (!(chart.width > 0)) return;
    const { context } = chart;
    const { width, height } = this.inner;
    chart.clear(colour("--stage"));
    const xs = options.xTicks?.(view.x0, view.x1) ?? ticks(view.x0, view.x1, width / 90);
    const ys = options.log ? decades(view.y0, view.y1) : options.yTicks?.(view.y0, view.y1) ?? ticks(view.y0, view.y1, height / 45);
    context.strokeStyle = colour("--rule");
    context.lineWidth = 1;
    context.beginPath();
    if (!options.both) {
      for (const x of xs) { context.moveTo(this.px(x), ROOM.top); context.lineTo(this.px(x), ROOM.top + height); }
      for (const y of ys) { context.moveTo(ROOM.left, this.py(y)); context.lineTo(ROOM.left + width, this.py(y)); }
    }
    context.stroke();
    context.save();
    context.beginPath();
    context.rect(ROOM.left, ROOM.top, width, height);
    context.clip();
    options.paint(this);
    if (this.cross) this.drawCross(width, height);
    context.restore();
    context.strokeStyle = colour("--guide");
    context.strokeRect(ROOM.left + 0.5, ROOM.top + 0.5, width - 1, height - 1);
    const muted = colour("--muted");
    for (const x of xs) chart.label(tickText(x), this.px(x), ROOM.top + height + 10, muted, "center");
    for (const y of ys) chart.label(options.log ? powerText(y) : tickText(y), ROOM.left - 6, this.py(y), muted, "right");
    chart.label(options.xLabel, ROOM.left + 0.5 * width, ROOM.top + height + 27, colour("--ink"), "center", 12, width + 2 * ROOM.right);
    context.save();
    context.translate(12, ROOM.top + 0.5 * height);
    context.rotate(-0.25 * TURN);
    chart.label(options.yLabel, 0, 0, colour("--ink"), "center", 12);
    context.restore();
  }

  drawCross(width, height) {
    const { context } = this.chart;
    context.strokeStyle = colour("--cursor");
    context.lineWidth = 1;
    context.beginPath();
    const x = Math.round(this.px(this.cross.x)) + 0.5;
    context.moveTo(x, ROOM.top);
    context.lineTo(x, ROOM.top + height);
    if (this.cross.y !== null) {
      const y = Math.round(this.py(this.cross.y)) + 0.5;
      context.moveTo(ROOM.left, y);
      context.lineTo(ROOM.left + width, y);
    }
    context.stroke();
  }
}

// A range moved, and shrunk if it must be, into the range that there is.
function within(low, high, least, most) {
  const size = Math.min(high - low, most - least);
  const begin = clamp(low, least, most - size);
  return [begin, begin + size];
}

// Values of a logarithmic axis from 10^low to 10^high: decades, and 2 and 5 between them where few are in view.
function decades(low, high) {
  const out = [];
  for (let d = Math.floor(low); d <= Math.ceil(high); d++) {
    for (const m of high - low < 2.5 ? [1, 2, 5] : [1]) {
      const v = Math.log10(m) + d;
      if (v >= low && v <= high) out.push(Number(`${m}e${d}`));
    }
  }
  return out.length > 1 ? out : ticks(10 ** low, 10 ** high, 4).filter((v) => v > 0);
}

const powerText = (v) => (v >= 1e-3 && v < 1e5 ? tickText(v) : v.toExponential(0).replace("-", "\u2212"));

let colours = null;
export function colour(name) {
  colours ??= new Map();
  if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  return colours.get(name);
}

export function forgetColours() { colours = null; }
