// Gaps along the flanks, and the deviations of a tooth.

import { TURN } from "../../page/kit/data.js";
import { Chart, extent, lowerBound, roomy, ticks, tickText } from "../../page/kit/charts.js";

// Gaps along the flanks of the near pairs, and both sides' deviations of the selected tooth.
export class FlankCharts {
  constructor(gaps, tooth, pair) {
    this.gaps = new Chart(gaps);
    this.tooth = new Chart(tooth);
    this.pair = pair;
  }

  drawGaps(state, range_um, followed, colours) {
    const chart = this.gaps;
    chart.fit();
    const { context, width, height } = chart;
    chart.clear(colours.panel);
    const [driving] = this.pair.gears;
    const left = 38, right = 8, top = 8, bottom = height - 26;
    const low = driving.radius[driving.root - 1], high = driving.r_a;
    const x = (r) => left + ((r - low) / (high - low)) * (width - left - right);
    const y = (um) => bottom - (um / range_um) * (bottom - top);
    for (const v of ticks(0, range_um, 4)) {
      context.strokeStyle = colours.line;
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(left, y(v));
      context.lineTo(width - right, y(v));
      context.stroke();
      chart.label(tickText(v), left - 5, y(v), colours.muted, "right");
    }
    for (const r of ticks(low, high, 4)) chart.label(tickText(r), x(r), bottom + 9, colours.muted, "center");
    chart.label("driving radius mm", width - right, height - 6, colours.muted, "right", 10.5);
    context.save();
    context.beginPath();
    context.rect(left, 0, width - left - right, bottom + 4);
    context.clip();
    const dashes = [[], [6, 3], [2, 3], [8, 3, 2, 3]];
    state.contacts.slice(0, 4).forEach((one, k) => {
      const curve = this.pair.gapCurve(state.theta_2, one, 1);
      context.beginPath();
      curve.radius.forEach((r, m) => {
        if (m === 0) context.moveTo(x(r), y(curve.gap[m]));
        else context.lineTo(x(r), y(curve.gap[m]));
      });
      context.setLineDash(dashes[k]);
      context.strokeStyle = one === followed ? colours.cursor : colours.curve;
      context.lineWidth = one === followed ? 2.2 : 1.4;
      context.stroke();
      context.setLineDash([]);
      context.beginPath();
      context.arc(x(one.radius[0]), y(one.gap_um), 3.5, 0, TURN);
      context.fillStyle = one.touching ? colours.touch : colours.panel;
      context.fill();
      context.strokeStyle = colours.touch;
      context.lineWidth = 1.5;
      context.stroke();
    });
    context.restore();
  }

  drawTooth(gear, tooth, contacts, colours) {
    const chart = this.tooth;
    chart.fit();
    const { context, width, height } = chart;
    chart.clear(colours.panel);
    const left = 38, right = 8, top = 8, bottom = height - 26;
    const from = gear.root - 1;
    const roll = (k) => Math.sqrt(Math.max(0, gear.radius[k] ** 2 - gear.r_b ** 2));
    const low = roll(from), high = roll(gear.n - 1);
    const curves = ["drive", "coast"].map((side) => {
      // As far as the tooth goes.
      const end = gear.chipped.has(tooth) ? lowerBound(gear.radius, gear.tipOf(tooth)) : gear.n;
      const values = new Float64Array(end - from);
      for (let k = from; k < end; k++) values[k - from] = gear.deviation(side, tooth, k);
      return values;
    });
    // Thickness puts the coast flank far off: each side about its own level, named in the card.
    const levels = curves.map((values) => values.reduce((sum, v) => sum + v, 0) / values.length);
    const shown = curves.map((values, k) => values.map((v) => v - levels[k]));
    const range = roomy(extent([0, ...extent(shown[0]), ...extent(shown[1])]));
    const x = (l) => left + ((l - low) / (high - low)) * (width - left - right);
    const y = (v) => bottom - ((v - range[0]) / (range[1] - range[0])) * (bottom - top);
    context.fillStyle = colours.window;
    context.fillRect(x(gear.l_start), top, width - right - x(gear.l_start), bottom - top);
    for (const v of ticks(range[0], range[1], 4)) {
      context.strokeStyle = v === 0 ? colours.guide : colours.line;
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(left, y(v));
      context.lineTo(width - right, y(v));
      context.stroke();
      chart.label(tickText(v), left - 5, y(v), colours.muted, "right");
    }
    for (const l of ticks(low, high, 4)) chart.label(tickText(l), x(l), bottom + 9, colours.muted, "center");
    chart.label("roll length mm, root to tip", width - right, height - 6, colours.muted, "right", 10.5);
    shown.forEach((values, k) => {
      context.beginPath();
      const every = Math.max(1, Math.floor(values.length / 1200));
      for (let m = 0; m < values.length; m += every) {
        if (m === 0) context.moveTo(x(roll(from)), y(values[0]));
        else context.lineTo(x(roll(from + m)), y(values[m]));
      }
      context.setLineDash(k === 0 ? [] : [5, 3]);
      context.strokeStyle = k === 0 ? colours.curve : colours.muted;
      context.lineWidth = k === 0 ? 1.7 : 1.3;
      context.stroke();
      context.setLineDash([]);
    });
    for (const one of contacts) {
      const r = one.radius[gear.name === "driving" ? 0 : 1];
      const l = Math.sqrt(Math.max(0, r * r - gear.r_b * gear.r_b));
      context.beginPath();
      context.moveTo(x(l), top);
      context.lineTo(x(l), bottom);
      context.strokeStyle = colours.cursor;
      context.lineWidth = one.touching ? 1.8 : 1;
      context.stroke();
    }
    return levels;
  }
}
