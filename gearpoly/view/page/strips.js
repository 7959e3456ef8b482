// TE over the hunting cycle and around the cursor, and the mismatch of a recording below.

import { clamp, modulo, TURN } from "../../page/kit/data.js";
import { Chart, extent, lowerBound, roomy, ticks, tickText } from "../../page/kit/charts.js";
import { element } from "../../page/kit/dom.js";

export const AROUND = 2.5; // pitches on either side of the cursor in the near strip

// The whole cycle and the stretch around the cursor, TE above and mismatch below where there is a recording.
export class Strips {
  constructor(whole, near, pair, recording) {
    this.whole = new Chart(whole);
    this.near = new Chart(near);
    this.pair = pair;
    this.recording = recording;
    this.teRange = roomy(extent(recording ? [...extent(pair.curve), ...extent(recording.recorded)] : pair.curve));
    if (recording) this.missRange = roomy(extent([0, ...extent(recording.mismatch)]));
    this.left = 46;
    this.right = 10;
    this.mark = element("mark");
  }

  lanes(height) {
    const top = 17, bottom = height - 16; // names stand above, angles below
    if (!this.recording) return [[top, bottom]];
    const middle = top + 0.54 * (bottom - top);
    return [[top, middle - 9], [middle + 9, bottom]];
  }

  // Least and greatest value per column of a curve on rising places.
  columns(places, values, width, span) {
    const low = new Float64Array(width).fill(Infinity), high = new Float64Array(width).fill(-Infinity);
    for (let k = 0; k < values.length; k++) {
      const column = Math.min(width - 1, Math.floor((places(k) / span) * width));
      if (values[k] < low[column]) low[column] = values[k];
      if (values[k] > high[column]) high[column] = values[k];
    }
    return [low, high];
  }

  paintWhole(colours) {
    const { whole, pair } = this;
    const width = Math.max(1, Math.floor(whole.width - this.left - this.right));
    const { context } = whole;
    whole.clear(colours.panel);
    const lanes = this.lanes(whole.height);
    const draw = (lane, range, places, values, colour) => {
      const y = (v) => lane[1] - ((v - range[0]) / (range[1] - range[0])) * (lane[1] - lane[0]);
      const [low, high] = this.columns(places, values, width, pair.cycle);
      context.strokeStyle = colour;
      context.lineWidth = 1;
      context.beginPath();
      for (let k = 0; k < width; k++) {
        if (!(low[k] <= high[k])) continue;
        const x = this.left + k + 0.5;
        context.moveTo(x, y(high[k]) - 0.5);
        context.lineTo(x, y(low[k]) + 0.5);
      }
      context.stroke();
      return y;
    };
    this.axes(context, whole.width, lanes[0], this.teRange, colours);
    draw(lanes[0], this.teRange, (k) => k * pair.step, pair.curve, colours.curve);
    if (this.recording) {
      this.axes(context, whole.width, lanes[1], this.missRange, colours);
      draw(lanes[1], this.missRange, (k) => this.recording.theta_2[k], this.recording.mismatch, colours.miss);
    }
    const turns = Math.round(pair.cycle / TURN);
    for (let turn = 0; turn <= turns; turn += Math.max(1, Math.ceil(turns / 12))) {
      const x = this.left + (width * turn) / turns;
      context.strokeStyle = colours.line;
      context.beginPath();
      context.moveTo(x, lanes[0][0]);
      context.lineTo(x, whole.height - 14);
      context.stroke();
      context.font = "11px system-ui, sans-serif";
      context.textAlign = turn === 0 ? "left" : turn === turns ? "right" : "center";
      context.textBaseline = "middle";
      context.fillStyle = colours.muted;
      context.fillText(String(turn), x, whole.height - 7);
    }
    this.label(context, lanes[0], "TE \u00b5m over the turns of the driven gear", colours);
    if (this.recording) this.label(context, lanes[1], "recorded \u2212 simulated \u00b5m", colours);
    this.painted = colours;
  }

  // A lane's name, above it.
  label(context, lane, name, colours) {
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.fillStyle = colours.muted;
    context.fillText(name, this.left, lane[0] - 9);
  }

  axes(context, width, lane, range, colours) {
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.textAlign = "right";
    context.lineWidth = 1;
    for (const v of ticks(range[0], range[1], Math.max(1, (lane[1] - lane[0]) / 26))) {
      const y = lane[1] - ((v - range[0]) / (range[1] - range[0])) * (lane[1] - lane[0]);
      if (y < lane[0] || y > lane[1]) continue;
      context.strokeStyle = v === 0 ? colours.guide : colours.line;
      context.beginPath();
      context.moveTo(this.left, y);
      context.lineTo(width - this.right, y);
      context.stroke();
      context.fillStyle = colours.muted;
      context.fillText(tickText(v), this.left - 5, y);
    }
  }

  // The strip of the cycle is drawn once; only its cursor moves.
  drawWhole(theta_2, colours) {
    const { whole, pair } = this;
    if (whole.fit() || this.painted !== colours) this.paintWhole(colours);
    const span = whole.width - this.left - this.right;
    const half = Math.max(2, (span * AROUND * pair.tau) / pair.cycle);
    this.mark.style.width = `${2 * half}px`;
    this.mark.style.transform = `translateX(${this.left + (span * theta_2) / pair.cycle - half}px)`;
  }

  cursor(context, x, top, bottom, colours) {
    context.beginPath();
    context.moveTo(x, top);
    context.lineTo(x, bottom);
    context.strokeStyle = colours.cursor;
    context.lineWidth = 1.6;
    context.stroke();
    context.beginPath();
    context.moveTo(x - 5, top - 3);
    context.lineTo(x + 5, top - 3);
    context.lineTo(x, top + 4);
    context.closePath();
    context.fillStyle = colours.cursor;
    context.fill();
  }

  drawNear(state, colours) {
    const { near, pair, recording } = this;
    near.fit();
    const { context, width, height } = near;
    const theta_2 = state.theta_2;
    near.clear(colours.panel);
    const lanes = this.lanes(height);
    const span = width - this.left - this.right;
    const reach = AROUND * pair.tau;
    const x = (theta) => this.left + span * (0.5 + (theta - theta_2) / (2 * reach));
    const first = Math.floor((theta_2 - reach) / pair.step), last = Math.ceil((theta_2 + reach) / pair.step);
    // The range that is in sight, so that a tenth of a micrometre shows.
    let low = Infinity, high = -Infinity;
    for (let k = first; k <= last; k++) {
      const v = pair.curve[modulo(k, pair.size)];
      low = Math.min(low, v);
      high = Math.max(high, v);
    }
    const seen = recording ? this.inSight(theta_2 - reach, theta_2 + reach) : [];
    for (const part of seen) {
      for (let k = part.from; k < part.to; k++) {
        low = Math.min(low, recording.recorded[k]);
        high = Math.max(high, recording.recorded[k]);
      }
    }
    const range = roomy([low, high]);
    context.save();
    context.beginPath();
    context.rect(this.left, 0, span, height);
    context.clip();
    // Where two or more pairs carry.
    context.fillStyle = colours.window;
    for (let k = first; k <= last; k++) {
      if (!(pair.counts[modulo(k, pair.size)] > 1)) continue;
      const from = k;
      while (k < last && pair.counts[modulo(k + 1, pair.size)] > 1) k++;
      const [low, high] = [x((from - 0.5) * pair.step), x((k + 0.5) * pair.step)];
      context.fillRect(low, lanes[0][0], high - low, lanes[0][1] - lanes[0][0]);
    }
    context.restore();
    this.axes(context, width, lanes[0], range, colours);
    const y = (lane, bounds) => (v) => lane[1] - ((v - bounds[0]) / (bounds[1] - bounds[0])) * (lane[1] - lane[0]);
    const teY = y(lanes[0], range);
    context.save();
    context.beginPath();
    context.rect(this.left, 0, span, height);
    context.clip();
    if (recording) this.dots(context, seen, x, teY, recording.recorded, colours.recorded);
    context.beginPath();
    for (let k = first; k <= last; k++) {
      const at = [x(k * pair.step), teY(pair.curve[modulo(k, pair.size)])];
      if (k === first) context.moveTo(...at);
      else context.lineTo(...at);
    }
    context.strokeStyle = colours.curve;
    context.lineWidth = 1.8;
    context.stroke();
    context.restore();
    if (recording) {
      let missLow = 0, missHigh = 0;
      for (const part of seen) {
        for (let k = part.from; k < part.to; k++) {
          missLow = Math.min(missLow, recording.mismatch[k]);
          missHigh = Math.max(missHigh, recording.mismatch[k]);
        }
      }
      const bounds = roomy([missLow, missHigh]);
      this.axes(context, width, lanes[1], bounds, colours);
      context.save();
      context.beginPath();
      context.rect(this.left, 0, span, height);
      context.clip();
      this.dots(context, seen, x, y(lanes[1], bounds), recording.mismatch, colours.miss);
      context.restore();
    }
    // Meshes stand where their pitch point passes the line of centres.
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = colours.muted;
    for (let mesh = Math.ceil((theta_2 - reach) / pair.tau); mesh * pair.tau <= theta_2 + reach; mesh++) {
      const [driving, driven] = pair.teeth(mesh, pair.data.flank);
      const shift = pair.sense > 0 ? 0 : 0.5 * pair.tau;
      const at = x(mesh * pair.tau + shift);
      if (at > this.left + 20 && at < width - 20) context.fillText(`${driving} on ${driven}`, at, height - 7);
    }
    this.label(context, lanes[0], recording ? "TE \u00b5m: line simulated, dots recorded" : "TE \u00b5m, shaded where several pairs touch", colours);
    if (recording) this.label(context, lanes[1], "recorded \u2212 simulated \u00b5m", colours);
    this.cursor(context, x(theta_2), lanes[0][0], height - 16, colours);
    context.beginPath();
    context.arc(x(theta_2), teY(state.curve_um), 4, 0, TURN);
    context.fillStyle = colours.cursor;
    context.fill();
  }

  dots(context, seen, x, y, values, colour) {
    context.fillStyle = colour;
    for (const part of seen) {
      const every = Math.max(1, Math.floor((part.to - part.from) / 4000));
      for (let k = part.from; k < part.to; k += every) {
        context.fillRect(x(this.recording.theta_2[k] + part.shift) - 1, y(values[k]) - 1, 2, 2);
      }
    }
  }

  // Samples between two angles, in up to two parts where the stretch passes the cycle's end.
  inSight(low, high) {
    const { cycle } = this.pair;
    const out = [];
    for (const shift of [-cycle, 0, cycle]) {
      const from = lowerBound(this.recording.theta_2, low - shift), to = lowerBound(this.recording.theta_2, high - shift);
      if (to > from) out.push({ from, to, shift });
    }
    return out;
  }

  // The angle under a pointer on one of the strips.
  angleAt(chart, px, theta_2) {
    const share = (px - this.left) / (chart.width - this.left - this.right);
    if (chart === this.whole) return clamp(share, 0, 1) * this.pair.cycle;
    return theta_2 + (share - 0.5) * 2 * AROUND * this.pair.tau;
  }
}
