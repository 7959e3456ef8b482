// What all curves are drawn with.

export class Chart {
  constructor(canvas) {
    this.canvas = canvas;
    // Opaque canvases are put on the page without blending.
    this.context = canvas.getContext("2d", { alpha: false });
  }

  clear(colour) {
    this.context.fillStyle = colour;
    this.context.fillRect(0, 0, this.width, this.height);
  }

  // Canvas in step with its box on the page; true where it changed.
  fit() {
    const ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    const changed = width !== this.width || height !== this.height || ratio !== this.ratio;
    if (changed) {
      this.width = width;
      this.height = height;
      this.ratio = ratio;
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    return changed;
  }

  // A text that is wider than `most` is drawn narrower.
  label(text, x, y, colour, align = "left", size = 11, most = Infinity) {
    const { context } = this;
    context.font = `${size}px system-ui, sans-serif`;
    context.textAlign = align;
    context.textBaseline = "middle";
    context.fillStyle = colour;
    context.fillText(text, x, y, Number.isFinite(most) ? most : undefined);
  }
}

// Round values that divide a range into a few steps.
export function ticks(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  if (!(raw > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(raw));
  const steps = [10, 5, 2, 1, 0.5, 0.2, 0.1].map((n) => n * power);
  const marks = (step) => Math.floor(high / step + 1e-9) - Math.ceil(low / step - 1e-9) + 1;
  // The smallest that makes no more than `count`, or a smaller one where that makes one mark, which is no scale.
  const wished = steps.findLastIndex((step) => step >= raw);
  const step = steps.slice(wished).find((one) => marks(one) > 1) ?? steps[6];
  const out = [];
  for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) out.push(Math.abs(v) < 1e-9 * step ? 0 : v);
  return out;
}

export const tickText = (v) => (v < 0 ? "\u2212" : "") + String(Number(Math.abs(v).toPrecision(6)));

export function extent(values) {
  let low = Infinity, high = -Infinity;
  for (let k = 0; k < values.length; k++) {
    if (values[k] < low) low = values[k];
    if (values[k] > high) high = values[k];
  }
  return [low, high];
}

// A range with room around it, never empty.
/** @param {number[]} range */
export function roomy([low, high]) {
  const room = Math.max(0.08 * (high - low), 0.02);
  return [low - room, high + room];
}

export function lowerBound(values, wish) {
  let low = 0, high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < wish) low = middle + 1;
    else high = middle;
  }
  return low;
}
