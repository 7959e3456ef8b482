// Where the view stands and how large it shows. Positions are subtracted from its centre in float64 before anything is
// scaled, so that a view 10 nm wide is as still as one of the whole gear.

import { clamp } from "../../page/kit/data.js";

const NARROWEST = 5e-6; // mm across the view: 5 nm, below which float64 coordinates of a gear run out

export class Camera {
  constructor() {
    this.x = 0;
    this.y = 0;
    this.scale = 1; // px per mm
    this.width = 1;
    this.height = 1;
  }

  px(x) { return 0.5 * this.width + (x - this.x) * this.scale; }

  py(y) { return 0.5 * this.height - (y - this.y) * this.scale; }

  world(px, py) {
    return [this.x + (px - 0.5 * this.width) / this.scale, this.y - (py - 0.5 * this.height) / this.scale];
  }

  // mm across the narrower side of the view.
  get across() { return Math.min(this.width, this.height) / this.scale; }

  // Half the view's diagonal, mm.
  get reach() { return (0.5 * Math.hypot(this.width, this.height)) / this.scale; }

  limit(scale, widest) {
    const side = Math.min(this.width, this.height);
    return clamp(scale, side / widest, side / NARROWEST);
  }
}

// A polygon in px as flat coordinates cut to a box, in float64: a canvas keeps float32 only, in which far vertices of a
// closely seen flank would make it tremble.
export function clipPolygon(points, box) {
  let input = points;
  for (let side = 0; side < 4; side++) {
    const axis = side >> 1;
    const limit = box[side];
    const sign = side & 1 ? -1 : 1;
    const output = [];
    const m = input.length / 2;
    if (m === 0) return input;
    let k = m - 1;
    let before = sign * (input[2 * k + axis] - limit);
    for (let next = 0; next < m; next++) {
      const now = sign * (input[2 * next + axis] - limit);
      if (before < 0 !== now < 0) {
        const t = before / (before - now);
        output.push(
          input[2 * k] + t * (input[2 * next] - input[2 * k]),
          input[2 * k + 1] + t * (input[2 * next + 1] - input[2 * k + 1]),
        );
      }
      if (now >= 0) output.push(input[2 * next], input[2 * next + 1]);
      before = now;
      k = next;
    }
    input = output;
  }
  return input;
}

// The part of a segment in px that lies in a box, or null (Liang-Barsky).
export function clipSegment(ax, ay, bx, by, box) {
  let low = 0, high = 1;
  const dx = bx - ax, dy = by - ay;
  for (const [p, q] of [[-dx, ax - box[0]], [dx, box[1] - ax], [-dy, ay - box[2]], [dy, box[3] - ay]]) {
    if (p === 0) {
      if (q < 0) return null;
    } else if (p < 0) {
      low = Math.max(low, q / p);
    } else {
      high = Math.min(high, q / p);
    }
  }
  if (low > high) return null;
  return [ax + low * dx, ay + low * dy, ax + high * dx, ay + high * dy];
}
