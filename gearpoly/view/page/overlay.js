// What is drawn upon the gears: contacts with normals and forces, gaps, the line of action, circles, numbers, a scale.

import { clamp, lengthText, TURN } from "../../page/kit/data.js";

const ARROW = 54; // px of a contact normal, and of a whole torque's force

export class Overlay {
  constructor(camera, picture, pair) {
    this.camera = camera;
    this.picture = picture;
    this.pair = pair;
  }

  text(context, text, x, y, colours, align = "left", size = 12, weight = 500) {
    context.font = `${weight} ${size}px system-ui, sans-serif`;
    context.textAlign = align;
    context.textBaseline = "middle";
    context.lineWidth = 3.5;
    context.strokeStyle = colours.halo;
    context.lineJoin = "round";
    context.strokeText(text, x, y);
    context.fillStyle = colours.ink;
    context.fillText(text, x, y);
  }

  circles(context, turns, colours) {
    this.pair.gears.forEach((gear, k) => {
      const axis = k === 0 ? 0 : this.pair.a;
      this.picture.circle(context, gear, gear.r, axis, turns[k], colours.guide, [10, 3, 2, 3]);
      this.picture.circle(context, gear, gear.r_b, axis, turns[k], colours.guide, [2, 3]);
    });
  }

  // The line of action of the carrying flank: the common tangent of both base circles through the pitch point.
  lineOfAction(context, colours) {
    const { pair, camera } = this;
    const [driving, driven] = pair.gears;
    const side = pair.sense;
    const alpha = pair.data.alpha_w;
    const along = [Math.sin(alpha), side * Math.cos(alpha)];
    const pitch = [driving.r_b / Math.cos(alpha), 0];
    const ends = [-driving.r_b * Math.tan(alpha), driven.r_b * Math.tan(alpha)];
    const at = (l) => [camera.px(pitch[0] + l * along[0]), camera.py(pitch[1] + l * along[1])];
    // Path of contact: between both tip circles.
    const roll = (gear) => Math.sqrt(gear.r_a * gear.r_a - gear.r_b * gear.r_b);
    const path = [ends[1] - roll(driven), ends[0] + roll(driving)];
    /** @type {[number[], number, number[]][]} */
    const lines = [[ends, 1, [7, 5]], [path, 2.2, []]];
    for (const [[low, high], width, dash] of lines) {
      const [p, q] = [at(low), at(high)];
      context.beginPath();
      this.picture.line(context, [...p, ...q]);
      context.setLineDash(dash);
      context.strokeStyle = colours.action;
      context.lineWidth = width;
      context.stroke();
      context.setLineDash([]);
    }
    const [px, py] = at(0);
    if (camera.scale > 4 && px > 0 && py > 0 && px < camera.width && py < camera.height) {
      context.beginPath();
      context.arc(px, py, 3, 0, TURN);
      context.fillStyle = colours.action;
      context.fill();
      if (camera.scale > 40) this.text(context, "C", px + 8, py + 12, colours);
    }
  }

  // One contact or near pair. A near pair's two points are those that will meet; the driving one stands back by the gap.
  contact(context, one, turns, followed, colours) {
    const { camera } = this;
    const back = turns.theta_1 - one.theta_1;
    const [c, d] = [Math.cos(back), Math.sin(back)];
    const mine = [c * one.point[0] - d * one.point[1], d * one.point[0] + c * one.point[1]];
    const [x, y] = [camera.px(one.point[0]), camera.py(one.point[1])];
    const [mx, my] = [camera.px(mine[0]), camera.py(mine[1])];
    if (Math.min(x, mx) > camera.width + 99 || Math.max(x, mx) < -99) return null;
    if (Math.min(y, my) > camera.height + 99 || Math.max(y, my) < -99) return null;
    const [nx, ny] = [one.normal[0], -one.normal[1]];
    if (turns.normals) {
      // Short where both gears are seen whole, so that the mesh stays legible.
      const reach = (one.touching ? 2.2 : 1) * ARROW * clamp(camera.scale / 60, 0.35, 1);
      context.beginPath();
      context.moveTo(x - nx * reach, y - ny * reach);
      context.lineTo(x + nx * reach, y + ny * reach);
      context.strokeStyle = colours.normal;
      context.lineWidth = 1.2;
      context.stroke();
      if (one.share === 0) this.arrow(context, x, y, nx, ny, 0.6 * reach, colours.normal, 1.2);
    }
    // The force on the driven tooth.
    if (one.share > 0) this.arrow(context, x, y, nx, ny, 16 + ARROW * one.share, colours.force, 4);
    const parted = Math.hypot(x - mx, y - my);
    if (!one.touching && parted > 3) {
      context.beginPath();
      this.picture.line(context, [mx, my, x, y]);
      context.strokeStyle = colours.ink;
      context.lineWidth = 1.5;
      context.stroke();
    }
    const size = followed ? 6.5 : 5;
    context.lineWidth = 2;
    context.strokeStyle = colours.halo;
    context.beginPath();
    if (one.touching) {
      context.arc(x, y, size, 0, TURN);
      context.fillStyle = colours.touch;
      context.fill();
      context.stroke();
    } else {
      for (const [px, py] of parted > 3 ? [[x, y], [mx, my]] : [[x, y]]) {
        context.moveTo(px, py - size);
        context.lineTo(px + size, py);
        context.lineTo(px, py + size);
        context.lineTo(px - size, py);
        context.closePath();
      }
      context.fillStyle = colours.halo;
      context.fill();
      context.strokeStyle = colours.touch;
      context.stroke();
    }
    if (followed) {
      context.beginPath();
      context.arc(x, y, size + 4.5, 0, TURN);
      context.strokeStyle = colours.touch;
      context.lineWidth = 1.5;
      context.stroke();
    }
    return { x, y, one };
  }

  arrow(context, x, y, nx, ny, length, colour, width) {
    const [ex, ey] = [x + nx * length, y + ny * length];
    const head = 5 + width;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(ex - nx * head, ey - ny * head);
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
    context.beginPath();
    context.moveTo(ex, ey);
    context.lineTo(ex - nx * head - ny * 0.5 * head, ey - ny * head + nx * 0.5 * head);
    context.lineTo(ex - nx * head + ny * 0.5 * head, ey - ny * head - nx * 0.5 * head);
    context.closePath();
    context.fillStyle = colour;
    context.fill();
  }

  // Words beside the contacts, moved apart where they would cover one another. `truth`: contacts of the true pair,
  // whose numbers stand beside an exaggerated one too.
  labels(context, marks, truth, colours) {
    if (this.camera.scale < 12) return;
    marks.sort((one, other) => one.y - other.y);
    let below = -Infinity;
    for (const { x, y, one } of marks) {
      const line = Math.max(y, below + 16);
      below = line;
      const real = truth.find((t) => t.driving === one.driving && t.driven === one.driven && t.flank === one.flank);
      const known = real || one;
      let words = known.touching ? "touches" : real ? `${known.gap_um.toPrecision(3)} \u00b5m` : "apart";
      if (known.force > 0) words = `${known.force.toFixed(0)} N, ${(100 * known.share).toFixed(0)} %`;
      if (known.feature !== "flank") words += `, ${known.feature}`;
      this.text(context, `${one.driving} on ${one.driven}: ${words}`, x + 18, line, colours, "left", 12, one.touching ? 650 : 500);
    }
  }

  numbers(context, gear, axis, turn, teeth, colours, selected) {
    const { camera } = this;
    const size = clamp(0.24 * gear.m * camera.scale * 2.2, 0, 15);
    if (size < 7.5) return;
    const radius = gear.r_f + 0.42 * (gear.r_a - gear.r_f);
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    for (const t of teeth) {
      const bx = radius * Math.cos(gear.lines[t]) + gear.centre[0];
      const by = radius * Math.sin(gear.lines[t]) + gear.centre[1];
      const x = camera.px(axis + c * bx - s * by), y = camera.py(s * bx + c * by);
      if (x < -20 || y < -20 || x > camera.width + 20 || y > camera.height + 20) continue;
      this.text(context, String(t), x, y, colours, "center", t === selected ? size + 2 : size, t === selected ? 750 : 550);
    }
  }

  scaleBar(context, colours) {
    const { camera } = this;
    const wish = 130 / camera.scale;
    const power = 10 ** Math.floor(Math.log10(wish));
    const length = power * (wish / power >= 5 ? 5 : wish / power >= 2 ? 2 : 1);
    const width = length * camera.scale;
    const x = 16, y = camera.height - 18;
    context.beginPath();
    context.moveTo(x, y - 5);
    context.lineTo(x, y);
    context.lineTo(x + width, y);
    context.lineTo(x + width, y - 5);
    context.strokeStyle = colours.halo;
    context.lineWidth = 5;
    context.stroke();
    context.strokeStyle = colours.ink;
    context.lineWidth = 1.6;
    context.stroke();
    this.text(context, lengthText(length), x + 4, y - 12, colours);
  }
}
