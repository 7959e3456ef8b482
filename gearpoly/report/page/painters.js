// What each kind of plot paints, and what its read-out says.

import { clamp, signed, TURN } from "../../page/kit/data.js";
import { lowerBound, roomy } from "../../page/kit/charts.js";
import { drawCurve, nearest } from "./levels.js";
import { colour, Plot, ROOM } from "./plot.js";

// Curves over a common x. curves: [{name, label, colour, curve, dash, width}], places of x.
export function curvePlot(figure, { title, xLabel, yLabel, least, source, readX, log = false }) {
  const shown = new Map(); // name: whether it is drawn
  const visible = () => source().curves.filter((one) => shown.get(one.name) ?? true);
  const extentIn = (x0, x1) => {
    const { places } = source();
    const k = Math.max(0, lowerBound(places, x0) - 1), m = Math.min(places.length, lowerBound(places, x1) + 2);
    let low = Infinity, high = -Infinity;
    for (const one of visible()) {
      const [a, b] = one.curve.extent(k, m);
      low = Math.min(low, a);
      high = Math.max(high, b);
    }
    if (!(low <= high)) [low, high] = [0, 1];
    if (!log) return roomy([low, high]);
    // The floor lies a little below what noise does; zeros would stretch the axis for nothing.
    const top = Math.log10(Math.max(high, 1e-9)) + 0.15;
    return [Math.min(Math.log10(Math.max(source().floor, 1e-9)), top - 1), top];
  };
  const plot = new Plot(figure, {
    title, xLabel, yLabel, least, log,
    home: () => {
      const { places, from = places[0] } = source();
      return [from, places[places.length - 1], ...extentIn(places[0], places[places.length - 1])];
    },
    fitted: (_, x0, x1) => extentIn(x0, x1),
    paint: (it) => {
      if (!log && it.view.y0 < 0 && it.view.y1 > 0) {
        const { context } = it.chart;
        context.strokeStyle = colour("--guide");
        context.beginPath();
        context.moveTo(ROOM.left, it.py(0));
        context.lineTo(ROOM.left + it.inner.width, it.py(0));
        context.stroke();
      }
      source().under?.(it);
      for (const one of visible()) {
        drawCurve(it, source().places, one.curve, {
          colour: colour(one.colour), dash: one.dash, width: one.width, gap: source().gap, dots: !log,
        });
      }
    },
    read: (_, x) => {
      const { places } = source();
      const k = nearest(places, x);
      const parts = visible().map((one) => {
        const [low, high] = one.curve.at(k);
        const value = one.curve.whole ? signed(low, 3) : log ? signed(high, 3) : `${signed(low, 3)} to ${signed(high, 3)}`;
        return `${one.label} ${value} \u00b5m`;
      });
      return { x: places[k], text: `${readX(places[k])}: ${parts.join(", ")}` };
    },
    step: (it, x, sign) => {
      const { places } = source();
      const pixel = (it.view.x1 - it.view.x0) / it.inner.width;
      const k = nearest(places, x);
      const far = nearest(places, places[k] + sign * pixel);
      return { x: places[clamp(far === k ? k + sign : far, 0, places.length - 1)], y: null };
    },
  });
  for (const one of source().curves) {
    const button = plot.bench.insertBefore(document.createElement("button"), plot.bench.querySelector(".push"));
    button.type = "button";
    button.className = `curve${one.dash ? " dashed" : ""}`;
    button.dataset.curve = one.name;
    button.setAttribute("aria-pressed", "true");
    const line = button.appendChild(document.createElement("i"));
    line.style.borderTopColor = `var(${one.colour})`;
    button.append(one.label);
    button.addEventListener("click", () => {
      const on = !(shown.get(one.name) ?? true);
      shown.set(one.name, on);
      button.setAttribute("aria-pressed", String(on));
      plot.refresh();
    });
  }
  return plot;
}

const rgb = (hex) => [1, 3, 5].map((k) => Number.parseInt(hex.slice(k, k + 2), 16));
const CELLS_CSS = { low: "--map-low", mid: "--map-mid", high: "--map-high" };

// Colour of a value between -top and top: from one hue over the background to the other.
function shade(value, top) {
  const share = clamp(value / top, -1, 1);
  const mid = rgb(colour(CELLS_CSS.mid)), end = rgb(colour(share < 0 ? CELLS_CSS.low : CELLS_CSS.high));
  const mixed = mid.map((v, k) => Math.round(v + (end[k] - v) * Math.abs(share)));
  return `rgb(${mixed.join(" ")})`;
}

const wholeTicks = (low, high, count) => {
  const step = Math.max(1, Math.ceil((high - low) / count));
  const out = [];
  for (let k = Math.ceil(low / step) * step; k <= high; k += step) out.push(k);
  return out;
};

// A map of teeth (rows) by mesh phase (cells). source() -> {values, rows, cells, top, std, marked}.
export function mapPlot(figure, { title, yLabel, rows, source }) {
  const cellAt = (x, y) => {
    const { cells } = source();
    return [clamp(Math.floor((x + 0.5) * cells), 0, cells - 1), clamp(Math.round(y ?? 0), 0, rows - 1)];
  };
  const plot = new Plot(figure, {
    title, yLabel, both: true, least: [0.1, 2],
    xLabel: "phase / pitches from the pitch point",
    home: () => [-0.5, 0.5, -0.5, rows - 0.5],
    yTicks: (low, high) => wholeTicks(low, high, Math.max(2, plot ? plot.inner.height / 18 : 12)),
    paint: (it) => {
      const { values, cells, top, marked } = source();
      const { context } = it.chart;
      for (let row = Math.max(0, Math.floor(it.view.y0)); row < Math.min(rows, it.view.y1 + 1); row++) {
        // Whole pixels: no seams between cells.
        const y = Math.round(it.py(row + 0.5)), height = Math.round(it.py(row - 0.5)) - y;
        for (let cell = 0; cell < cells; cell++) {
          const value = values[row * cells + cell];
          context.fillStyle = Number.isNaN(value) ? colour("--void") : shade(value, top);
          const x = Math.round(it.px(cell / cells - 0.5));
          context.fillRect(x, y, Math.round(it.px((cell + 1) / cells - 0.5)) - x, height);
        }
        if (marked.includes(row)) {
          context.strokeStyle = colour("--ink");
          context.lineWidth = 1.5;
          context.strokeRect(it.px(-0.5) + 1, y + 1, it.px(0.5) - it.px(-0.5) - 2, height - 2);
        }
      }
    },
    read: (_, x, y) => {
      const { values, cells, std } = source();
      const [cell, row] = cellAt(x, y);
      const value = values[row * cells + cell];
      const size = Number.isNaN(value) ? "not recorded" : `${signed(value, 3)} \u00b1 ${signed(std, 3)} \u00b5m`;
      return { text: `tooth ${row}, phase ${signed(cell / cells - 0.5, 2)} to ${signed((cell + 1) / cells - 0.5, 2)}: ${size}` };
    },
    step: (_, x, sign) => {
      const { cells } = source();
      const [cell, row] = cellAt(x, plot.cross?.y);
      const place = clamp(row * cells + cell + sign, 0, rows * cells - 1);
      return { x: ((place % cells) + 0.5) / cells - 0.5, y: Math.floor(place / cells) };
    },
  });
  const key = plot.bench.insertBefore(document.createElement("span"), plot.bench.firstChild);
  key.className = "key";
  key.append(document.createElement("span"), document.createElement("i"), document.createElement("span"));
  plot.rekey = () => {
    const { top } = source();
    key.firstChild.textContent = `\u2212${top.toPrecision(2)}`;
    key.lastChild.textContent = `${top.toPrecision(2)} \u00b5m`;
    plot.refresh();
  };
  plot.rekey();
  return plot;
}

// A value with its standard error per tooth. source: {values, stds, marked}.
export function teethPlot(figure, { title, yLabel, paint, source }) {
  const all = source;
  const size = all.values.length;
  const extentIn = (x0, x1) => {
    let low = 0, high = 0;
    for (let k = Math.max(0, Math.ceil(x0)); k <= Math.min(size - 1, x1); k++) {
      if (!Number.isFinite(all.values[k] + all.stds[k])) continue;
      low = Math.min(low, all.values[k] - all.stds[k]);
      high = Math.max(high, all.values[k] + all.stds[k]);
    }
    return roomy([low, high]);
  };
  const toothAt = (x) => clamp(Math.round(x), 0, size - 1);
  const plot = new Plot(figure, {
    title, yLabel, least: [3, 0.05], xLabel: "tooth",
    home: () => [-0.7, size - 0.3, ...extentIn(0, size)],
    fitted: (_, x0, x1) => extentIn(x0, x1),
    xTicks: (low, high) => wholeTicks(low, high, Math.max(3, plot ? plot.inner.width / 34 : 10)).filter((k) => k < size),
    paint: (it) => {
      const { context } = it.chart;
      const pitch = it.px(1) - it.px(0), half = clamp(0.32 * pitch, 1, 12);
      context.fillStyle = context.strokeStyle = colour(paint);
      for (let k = Math.max(0, Math.floor(it.view.x0)); k < Math.min(size, it.view.x1 + 1); k++) {
        const x = it.px(k);
        context.globalAlpha = 0.3;
        context.fillRect(x - half, Math.min(it.py(0), it.py(all.values[k])), 2 * half, Math.abs(it.py(0) - it.py(all.values[k])));
        context.globalAlpha = 1;
        context.fillRect(x - half, it.py(all.values[k]) - 1, 2 * half, 2);
        context.lineWidth = 1.4;
        context.beginPath();
        context.moveTo(x, it.py(all.values[k] - all.stds[k]));
        context.lineTo(x, it.py(all.values[k] + all.stds[k]));
        context.stroke();
        if (all.marked.includes(k)) {
          context.save();
          context.strokeStyle = colour("--ink");
          context.lineWidth = 1.6;
          context.beginPath();
          context.arc(x, it.py(all.values[k]), 7, 0, TURN);
          context.stroke();
          context.restore();
        }
      }
      context.strokeStyle = colour("--guide");
      context.beginPath();
      context.moveTo(ROOM.left, it.py(0));
      context.lineTo(ROOM.left + it.inner.width, it.py(0));
      context.stroke();
    },
    read: (_, x) => {
      const k = toothAt(x);
      return { x: k, text: `tooth ${k}: ${signed(all.values[k], 2)} \u00b1 ${signed(all.stds[k], 2)} \u00b5m` };
    },
    step: (_, x, sign) => ({ x: toothAt(toothAt(x) + sign), y: null }),
  });
  return plot;
}
