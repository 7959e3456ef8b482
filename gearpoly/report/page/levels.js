// Long curves in levels of detail: each keeps the least and the greatest of every stretch, so that no peak is lost.

import { clamp, TURN } from "../../page/kit/data.js";
import { lowerBound } from "../../page/kit/charts.js";

const TWO = 2; // values of one level under one of the next
const FEW = 512; // values that need no further level

export class Curve {
  // low, high: arrays of one length; high null where each value stands for itself.
  constructor({ low, high }) {
    this.whole = high === null;
    this.levels = [{ step: 1, low, high: high ?? low }];
    for (let last = this.levels[0]; last.low.length > FEW; last = this.levels[this.levels.length - 1]) {
      const size = Math.ceil(last.low.length / TWO);
      const next = { step: TWO * last.step, low: new Float32Array(size), high: new Float32Array(size) };
      for (let k = 0; k < size; k++) {
        let least = Infinity, most = -Infinity;
        for (let j = TWO * k; j < Math.min(last.low.length, TWO * k + TWO); j++) {
          if (last.low[j] < least) least = last.low[j];
          if (last.high[j] > most) most = last.high[j];
        }
        next.low[k] = least;
        next.high[k] = most;
      }
      this.levels.push(next);
    }
  }

  get size() { return this.levels[0].low.length; }

  at(k) { return [this.levels[0].low[k], this.levels[0].high[k]]; }

  // The coarsest level that still has about one value per pixel for `count` values over `pixels`.
  level(count, pixels) {
    let chosen = this.levels[0];
    for (const one of this.levels) if (count / one.step >= pixels) chosen = one;
    return chosen;
  }

  // Least and greatest of the values from k to m (m excluded).
  extent(k = 0, m = this.size) {
    const one = this.level(m - k, 256);
    let low = Infinity, high = -Infinity;
    for (let j = Math.floor(k / one.step); j < Math.min(one.low.length, Math.ceil(m / one.step)); j++) {
      if (one.low[j] < low) low = one.low[j];
      if (one.high[j] > high) high = one.high[j];
    }
    return [low, high];
  }
}

// The number of the place next to x.
export function nearest(places, x) {
  const k = clamp(lowerBound(places, x), 0, places.length - 1);
  return k > 0 && x - places[k - 1] < places[k] - x ? k - 1 : k;
}

// Draw `curve` over `places` into the plot: a line, or columns from least to greatest where values are denser than pixels.
export function drawCurve(plot, places, curve, style) {
  const first = Math.max(0, lowerBound(places, plot.view.x0) - 1);
  const last = Math.min(places.length, lowerBound(places, plot.view.x1) + 2);
  const level = curve.level(last - first, plot.inner.width);
  if (last - first > plot.inner.width && !style.dash) drawColumns(plot, places, level, [first, last], style);
  else drawLine(plot, places, level, [first, last], style);
  // Single samples become visible where there is room for them.
  if (curve.whole && style.dots && last - first < plot.inner.width / 8) {
    const { context } = plot.chart;
    context.fillStyle = style.colour;
    for (let k = first; k < last; k++) {
      context.beginPath();
      context.arc(plot.px(places[k]), plot.py(curve.at(k)[0]), 2.2, 0, TURN);
      context.fill();
    }
  }
}

// Calls act(begin, end, low, high) for every stretch of a level that holds values first to last.
function stretches(places, level, [first, last], act) {
  const { step, low, high } = level;
  for (let j = Math.floor(first / step); j < Math.min(low.length, Math.ceil(last / step)); j++) {
    act(places[j * step], places[Math.min(places.length, (j + 1) * step) - 1], low[j], high[j]);
  }
}

function drawLine(plot, places, level, range, style) {
  const { context } = plot.chart;
  const gap = style.gap ?? Infinity;
  let end = NaN;
  context.beginPath();
  stretches(places, level, range, (begin, stop, low, high) => {
    const x = plot.px(0.5 * (begin + stop));
    if (begin - end > gap || Number.isNaN(end)) context.moveTo(x, plot.py(low));
    else context.lineTo(x, plot.py(low));
    if (high !== low) context.lineTo(x, plot.py(high));
    end = stop;
  });
  context.strokeStyle = style.colour;
  context.lineWidth = style.width ?? 1.2;
  context.lineJoin = "bevel";
  context.setLineDash(style.dash ?? []);
  context.stroke();
  context.setLineDash([]);
}

// One upright bar per column of pixels, each reaching the one before it: ten times as fast as a line of as many points.
function drawColumns(plot, places, level, range, style) {
  const { context } = plot.chart;
  const gap = style.gap ?? Infinity;
  const width = Math.max(1, Math.round(style.width ?? 1)), room = 0.5 * width;
  let column = NaN, least = Infinity, most = -Infinity; // the column being gathered, in pixels
  let end = NaN, top = NaN, bottom = NaN; // the end of the stretch before, and its bar
  context.fillStyle = style.colour;
  const put = () => {
    if (most >= least) context.fillRect(column - Math.floor(room), least - room, width, most - least + width);
  };
  stretches(places, level, range, (begin, stop, low, high) => {
    const at = Math.floor(plot.px(0.5 * (begin + stop)));
    const joined = begin - end <= gap;
    const up = plot.py(high), down = plot.py(low);
    if (at !== column) {
      put();
      [column, least, most] = [at, Infinity, -Infinity];
    }
    least = Math.min(least, up, joined ? bottom : up);
    most = Math.max(most, down, joined ? top : down);
    [end, top, bottom] = [stop, up, down];
  });
  put();
}
