// The gears themselves: filled polygons of the teeth in view, as many vertices as the screen can tell apart.

import { clamp, modulo, TURN, UM } from "../../page/kit/data.js";
import { clipPolygon, clipSegment } from "./camera.js";

const MARGIN = 0.05; // mm beyond the view within which every vertex is looked at; coarser chords bend in by less
const COARSE = 0.25; // mm between vertices further outside
const FAR = 16000; // px; beyond, a path is cut to the view before the canvas rounds it to float32

export class Picture {
  constructor(camera) {
    this.camera = camera;
  }

  // Grid points of a gear worth drawing: those in view at a pixel's spacing, few elsewhere; `radius` of its grid.
  ladder(gear, axis, radius = gear.radius) {
    const { camera } = this;
    const distance = Math.hypot(camera.x - axis, camera.y);
    const play = MARGIN + Math.hypot(gear.centre[0], gear.centre[1]);
    const low = distance - camera.reach - play;
    const high = distance + camera.reach + play;
    const fine = Math.min(2.4 / camera.scale, COARSE); // a fillet then stands off its chords by 0.1 px at most
    const out = [];
    let from = -Infinity;
    for (let k = 0; k < gear.n; k++) {
      const seen = radius[k] >= low && radius[k] <= high;
      if (k === 0 || k === gear.n - 1 || k === gear.root - 1 || gear.arc[k] - from >= (seen ? fine : COARSE)) {
        out.push(k);
        from = gear.arc[k];
      }
    }
    return out;
  }

  // Teeth whose sector reaches into the view, `turn` the gear's rotation in rad.
  visible(gear, axis, turn) {
    const { camera } = this;
    const distance = Math.hypot(camera.x - axis, camera.y);
    const reach = camera.reach + Math.hypot(gear.centre[0], gear.centre[1]);
    if (distance - reach > gear.r_a) return [];
    const towards = Math.atan2(camera.y, camera.x - axis);
    const half = distance <= reach ? Math.PI : Math.asin(reach / distance) + 0.75 * gear.tau;
    const out = [];
    for (let t = 0; t < gear.z; t++) {
      if (Math.abs(modulo(gear.lines[t] + turn - towards + Math.PI, TURN) - Math.PI) <= half) out.push(t);
    }
    return out;
  }

  get box() {
    const { camera } = this;
    return [-60, camera.width + 60, -60, camera.height + 60];
  }

  // A face or a part of an outline as px from body coordinates.
  seen(xy, indices, base, axis, c, s, out) {
    const { camera } = this;
    const halfWidth = 0.5 * camera.width, halfHeight = 0.5 * camera.height;
    for (let m = 0; m < indices.length; m++) {
      const at = 2 * (base + indices[m]);
      const x = axis + c * xy[at] - s * xy[at + 1];
      const y = s * xy[at] + c * xy[at + 1];
      out.push(halfWidth + (x - camera.x) * camera.scale, halfHeight - (y - camera.y) * camera.scale);
    }
  }

  // Points of an arc about the gear's own centre, in px; angles in rad at rotation 0.
  arc(gear, radius, start, end, count, axis, c, s, out) {
    for (let m = 0; m <= count; m++) {
      const angle = start + ((end - start) * m) / count;
      const x = radius * Math.cos(angle) + gear.centre[0];
      const y = radius * Math.sin(angle) + gear.centre[1];
      out.push(this.camera.px(axis + c * x - s * y), this.camera.py(s * x + c * y));
    }
  }

  trace(context, points, closed) {
    context.moveTo(points[0], points[1]);
    for (let m = 2; m < points.length; m += 2) context.lineTo(points[m], points[m + 1]);
    if (closed) context.closePath();
  }

  // A polyline, cut where it leaves the view by far.
  line(context, points) {
    let far = false;
    for (let m = 0; m < points.length && !far; m++) far = Math.abs(points[m]) > FAR;
    if (!far) {
      this.trace(context, points, false);
      return;
    }
    const { box } = this;
    let endX = NaN, endY = NaN;
    for (let m = 0; m + 3 < points.length; m += 2) {
      const cut = clipSegment(points[m], points[m + 1], points[m + 2], points[m + 3], box);
      if (!cut) continue;
      if (cut[0] !== endX || cut[1] !== endY) context.moveTo(cut[0], cut[1]);
      context.lineTo(cut[2], cut[3]);
      endX = cut[2];
      endY = cut[3];
    }
  }

  fill(context, points) {
    let far = false;
    for (let m = 0; m < points.length && !far; m++) far = Math.abs(points[m]) > FAR;
    const kept = far ? clipPolygon(points, this.box) : points;
    if (kept.length >= 6) this.trace(context, kept, true);
  }

  // One gear turned by `turn` about (axis, 0), deviations magnified K times; `selected` tooth or -1.
  gear(context, gear, axis, turn, K, colours, selected) {
    const teeth = this.visible(gear, axis, turn);
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    const indices = this.ladder(gear, axis);
    const drive = gear.faces("drive", K), coast = gear.faces("coast", K);
    const bore = Math.max(2, Math.min(24, Math.ceil(gear.tau * gear.r_bore * this.camera.scale / 4)));
    const ring = 0.5 * gear.tau;
    context.beginPath();
    const outlines = [];
    for (const t of teeth) {
      /** @type {number[] & {count?: number}} */
      const outline = [];
      const r_tip = gear.tipOf(t);
      const mine = gear.chipped.has(t) ? this.ladder(gear, axis, gear.radiiOf(t)) : indices;
      this.seen(coast.xy, mine, t * gear.n, axis, c, s, outline);
      const tip = [
        gear.lines[t] - gear.angleAt("coast", t, gear.n - 1, K), gear.lines[t] + gear.angleAt("drive", t, gear.n - 1, K),
      ];
      // Enough chords that none stands off the tip circle by a tenth of a pixel, but no more than a view can show.
      const chords = clamp(Math.ceil((tip[1] - tip[0]) * Math.sqrt(1.25 * r_tip * this.camera.scale)), 2, 400);
      this.arc(gear, r_tip, tip[0], tip[1], chords, axis, c, s, outline);
      this.seen(drive.xy, mine.slice().reverse(), t * gear.n, axis, c, s, outline);
      outline.count = mine.length; // points of either face
      outlines.push(outline);
      const whole = outline.slice();
      this.arc(gear, gear.r_bore, gear.lines[t] + ring, gear.lines[t] - ring, bore, axis, c, s, whole);
      this.fill(context, whole);
    }
    context.fillStyle = colours.fill;
    context.fill();
    if (selected >= 0 && teeth.includes(selected)) {
      context.beginPath();
      this.fill(context, outlines[teeth.indexOf(selected)]);
      context.fillStyle = colours.selected;
      context.fill();
    }
    context.beginPath();
    for (const outline of outlines) this.line(context, outline);
    context.strokeStyle = colours.line;
    context.lineWidth = 1.4;
    context.lineJoin = "bevel"; // round joins of so many short chords cost a third of a frame
    context.stroke();
    this.circle(context, gear, gear.r_bore, axis, turn, colours.line, []);
    this.vertices(context, outlines, colours.line);
    return teeth;
  }

  // The polygon's own vertices, once they stand far enough apart to be told. An outline begins with one face and ends
  // with the other; the tip between them is an arc.
  vertices(context, outlines, colour) {
    const { camera } = this;
    if (camera.scale < 500) return;
    context.fillStyle = colour;
    for (const outline of outlines) {
      const { count } = outline;
      const all = outline.length / 2;
      for (let m = 0; m < 2 * count; m++) {
        const at = 2 * (m < count ? m : all - 2 * count + m);
        const x = outline[at], y = outline[at + 1];
        if (x < -4 || y < -4 || x > camera.width + 4 || y > camera.height + 4) continue;
        const next = at + 2 < outline.length ? at + 2 : at - 2;
        if (Math.hypot(outline[next] - x, outline[next + 1] - y) < 14) continue;
        context.fillRect(x - 2, y - 2, 4, 4);
      }
    }
  }

  // The flanks of the teeth in view without deviations, for comparison; beside magnified ones those of the mean tooth.
  ideal(context, gear, axis, turn, teeth, K, colour) {
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    const indices = this.ladder(gear, axis);
    context.beginPath();
    for (const t of teeth) {
      for (const sign of [1, -1]) {
        const points = [];
        for (const k of indices) {
          const side = sign > 0 ? "drive" : "coast";
          const mean = K === 1 || k === 0 ? 0 : (gear.mean[side] * UM) / gear.r_b;
          const angle = gear.lines[t] + sign * (gear.psi[k] + mean);
          const x = gear.radius[k] * Math.cos(angle) + gear.centre[0];
          const y = gear.radius[k] * Math.sin(angle) + gear.centre[1];
          points.push(this.camera.px(axis + c * x - s * y), this.camera.py(s * x + c * y));
        }
        this.line(context, points);
      }
    }
    context.setLineDash([5, 4]);
    context.strokeStyle = colour;
    context.lineWidth = 1;
    context.stroke();
    context.setLineDash([]);
  }

  // A circle about the gear's centre, as chords fine enough for the view.
  circle(context, gear, radius, axis, turn, colour, dash) {
    const { camera } = this;
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    const x = axis + c * gear.centre[0] - s * gear.centre[1];
    const y = s * gear.centre[0] + c * gear.centre[1];
    const distance = Math.hypot(camera.x - x, camera.y - y);
    if (Math.abs(distance - radius) > camera.reach) return;
    // In view lies an arc towards the view's centre at most as long as the view.
    const towards = Math.atan2(camera.y - y, camera.x - x);
    const half = camera.reach >= 0.5 * radius ? Math.PI : (1.6 * camera.reach) / radius;
    const points = [];
    const count = 180;
    for (let m = 0; m <= count; m++) {
      const angle = towards - half + (2 * half * m) / count;
      points.push(camera.px(x + radius * Math.cos(angle)), camera.py(y + radius * Math.sin(angle)));
    }
    context.beginPath();
    this.line(context, points);
    context.setLineDash(dash);
    context.strokeStyle = colour;
    context.lineWidth = 1;
    context.stroke();
    context.setLineDash([]);
  }
}
