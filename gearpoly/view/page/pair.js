// The pair at one driven angle: which teeth touch, where, along which normal, and how far the others are.

import { modulo, UM } from "../../page/kit/data.js";
import { Gear } from "./gear.js";
import { best, closing, describeTouch } from "./contact.js";

const NEAR_UM = 400; // pairs further apart than this along the line of action are not worth a row
const PASSED = 0.25; // driving pitches; a pair that would have closed so much earlier has left contact

export class Pair {
  constructor(data) {
    this.data = data;
    this.gears = data.gears.map((raw) => new Gear(raw));
    const [driving, driven] = this.gears;
    this.a = data.a;
    this.ratio = driving.z / driven.z;
    this.tau = driven.tau;
    this.cycle = data.cycle;
    this.sense = data.flank === "drive" ? 1 : -1;
    const s = data.samples;
    this.step = this.tau / data.per_mesh;
    this.te = s.te_um;
    this.backlash = s.backlash_um;
    this.counts = s.pairs;
    this.size = this.te.length;
    this.loaded = "approach_um" in s;
    if (this.loaded) {
      this.approach = s.approach_um;
      this.stiffness = s.stiffness_n_per_um;
      this.carrying = s.carrying;
      this.rows = { driving: s.driving, driven: s.driven, force: s.force_n };
      this.start = new Uint32Array(this.size + 1);
      for (let k = 0; k < this.size; k++) this.start[k + 1] = this.start[k] + this.carrying[k];
    }
    // What the simulation says of TE, load included: the curve under the cursor.
    this.curve = Float64Array.from(this.te);
    if (this.loaded) for (let k = 0; k < this.size; k++) this.curve[k] -= this.sense * this.approach[k];
    this.widest = Math.min(...this.gears.map((gear) => gear.widest));
  }

  // The sample at or before theta_2, and the share of the way to the next.
  between(theta_2) {
    const place = modulo(theta_2, this.cycle) / this.step;
    const whole = Math.round(place);
    // On a sample the next one has no say, however angles round.
    if (Math.abs(place - whole) < 1e-7) return [whole % this.size, 0];
    return [Math.min(Math.floor(place), this.size - 1), place - Math.floor(place)];
  }

  // A simulated curve at theta_2, straight between its samples.
  interpolated(values, theta_2) {
    const [k, share] = this.between(theta_2);
    return values[k] * (1 - share) + values[(k + 1) % this.size] * share;
  }

  // Normal force in N between two teeth, straight between samples.
  force(theta_2, driving, driven) {
    const [k, share] = this.between(theta_2);
    const at = (sample) => {
      for (let row = this.start[sample]; row < this.start[sample + 1]; row++) {
        if (this.rows.driving[row] === driving && this.rows.driven[row] === driven) return this.rows.force[row];
      }
      return 0;
    };
    return at(k) * (1 - share) + (share > 0 ? at((k + 1) % this.size) * share : 0);
  }

  // Driven tooth that driving tooth of mesh n meets on a flank.
  teeth(mesh, flank) {
    const [driving, driven] = this.gears;
    return [modulo(mesh, driving.z), modulo(flank === "drive" ? mesh : mesh + 1, driven.z)];
  }

  // Where a mesh passes the middle of its contact: tooth 0's drive flank at angle 0, the coast flank half a pitch late.
  angleOf(mesh) {
    return modulo((mesh + (this.sense > 0 ? 0 : 0.5)) * this.tau, this.cycle);
  }

  // Poses for the kernel at theta_2: the driving rotation in the sense of closing from which it searches.
  posed(theta_2, flank) {
    const s = flank === "drive" ? 1 : -1;
    let te = this.interpolated(this.te, theta_2);
    // TE of the coast flank is higher by the backlash.
    if (flank !== this.data.flank) te -= s * this.interpolated(this.backlash, theta_2);
    const guess = s * ((theta_2 - (te * UM) / this.gears[1].r_b) / this.ratio);
    const pose = -s * theta_2;
    const [cp, sp] = [Math.cos(pose), Math.sin(pose)];
    const [cg, sg] = [Math.cos(guess), Math.sin(guess)];
    return { s, guess, pose, at: [-this.a * cp, this.a * sp, cp * cg + sp * sg, sp * cg - cp * sg] };
  }

  // First touch and near pairs of one flank, unloaded, deviations magnified K times. Null where nothing touches.
  flank(theta_2, flank, K) {
    const { s, guess, pose, at } = this.posed(theta_2, flank);
    const [A, B] = this.gears.map((gear) => gear.faces(flank, K));
    const [driving, driven] = this.gears;
    const middle = Math.floor(theta_2 / this.tau);
    const found = [];
    for (let mesh = middle - 3; mesh <= middle + 3; mesh++) {
      const [i, j] = this.teeth(mesh, flank);
      if (!closing(A, i, B, j, s, at)) continue;
      const rotation = Math.atan2(best.sine, best.cosine);
      if (rotation < -PASSED * driving.tau) continue;
      found.push({ mesh, driving: i, driven: j, rotation, touch: { ...best } });
    }
    if (found.length === 0) return null;
    found.sort((one, other) => one.rotation - other.rotation);
    const first = found[0].rotation;
    const contacts = [];
    for (const one of found) {
      const gap_um = ((one.rotation - first) * driving.r_b) / UM;
      if (gap_um > K * NEAR_UM) break;
      const forward = guess + one.rotation;
      const { normal, feature } = describeTouch(A, one.driving, B, one.driven, s, one.touch, pose - forward);
      const [c, d] = [Math.cos(forward), Math.sin(forward)];
      const turned = (x, y) => [c * x - d * y, s * (d * x + c * y)];
      const point = turned(one.touch.x, one.touch.y);
      contacts.push({
        mesh: one.mesh, driving: one.driving, driven: one.driven, flank, gap_um, feature, point,
        normal: turned(normal[0], normal[1]),
        radius: [Math.hypot(point[0], point[1]), Math.hypot(point[0] - this.a, point[1])],
        theta_1: s * forward, touching: false, force: 0, share: 0,
      });
    }
    // Chords let one of several truly touching pairs lead by at most their sagittas; a corner counts only alone.
    const flanks = contacts.filter((one) => one.gap_um <= K * this.data.chord_noise_um && one.feature === "flank");
    for (const one of flanks.length > 0 ? flanks : contacts.slice(0, 1)) one.touching = true;
    const theta_1 = s * (guess + first);
    return { theta_1, te_um: ((theta_2 - this.ratio * theta_1) * driven.r_b) / UM, contacts };
  }

  // Everything about the pair at theta_2 in rad. With magnification the contacts are those of the drawn, exaggerated
  // pair; `loaded` false leaves the load out.
  solve(theta_2, K = 1, loaded = this.loaded) {
    const drive = this.flank(theta_2, "drive", K);
    const coast = this.flank(theta_2, "coast", K);
    const seen = this.data.flank === "drive" ? drive : coast;
    if (!seen) return null;
    const out = {
      theta_2, drive, coast, contacts: seen.contacts, other: this.data.flank === "drive" ? coast : drive,
      te_um: seen.te_um, theta_1: seen.theta_1, unloaded_te_um: seen.te_um, approach_um: 0, stiffness: null,
      backlash_um: drive && coast ? coast.te_um - drive.te_um : null,
      magnify: K,
    };
    out.pairs = seen.contacts.filter((one) => one.touching).length;
    if (!(loaded && this.loaded && K === 1)) return out;
    out.approach_um = this.interpolated(this.approach, theta_2);
    out.stiffness = this.interpolated(this.stiffness, theta_2);
    out.te_um -= this.sense * out.approach_um;
    out.theta_1 = (theta_2 - (out.te_um * UM) / this.gears[1].r_b) / this.ratio;
    let total = 0;
    for (const one of out.contacts) {
      one.force = this.force(theta_2, one.driving, one.driven);
      total += one.force;
    }
    for (const one of out.contacts) {
      one.share = total > 0 ? one.force / total : 0;
      one.touching = one.force > 0;
    }
    out.pairs = out.contacts.filter((one) => one.touching).length;
    return out;
  }

  // Gap in um along the line of action between two faces over the driving radius in mm, beyond the first touch.
  gapCurve(theta_2, contact, K) {
    const { s, at } = this.posed(theta_2, contact.flank);
    const [A, B] = this.gears.map((gear) => gear.faces(contact.flank, K));
    const radius = [], gap = [];
    const stride = Math.max(1, Math.floor(B.n / 160));
    closing(A, contact.driving, B, contact.driven, s, at, (r, turn) => {
      radius.push(r);
      gap.push((turn * this.gears[0].r_b) / UM);
    }, stride);
    closing(A, contact.driving, B, contact.driven, s, at);
    const least = (Math.atan2(best.sine, best.cosine) * this.gears[0].r_b) / UM;
    for (let k = 0; k < gap.length; k++) gap[k] += contact.gap_um - least;
    return { radius, gap };
  }

  // The worst difference between this page's kernel and the simulation: TE in um, contact points in um.
  check() {
    const raw = this.data.check;
    const position = raw.position, driving = raw.driving, driven = raw.driven;
    const point = raw.point;
    let te_um = 0, point_um = 0;
    for (let k = 0; k < position.length; k++) {
      const found = this.flank(position[k] * this.step, this.data.flank, 1);
      if (!found) return { te_um: Infinity, point_um: Infinity, positions: position.length };
      te_um = Math.max(te_um, Math.abs(found.te_um - this.te[position[k]]));
      const same = found.contacts.find((one) => one.driving === driving[k] && one.driven === driven[k]);
      // Two pairs that touch at once may change places.
      const off = same && same.gap_um < 1e-6
        ? Math.hypot(same.point[0] - point[2 * k], same.point[1] - point[2 * k + 1]) / UM : Infinity;
      point_um = Math.max(point_um, off);
    }
    return { te_um, point_um, positions: position.length };
  }
}
