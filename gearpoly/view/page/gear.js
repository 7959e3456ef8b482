// One gear as drawn: an ideal flank, and each tooth's deviation from it. All teeth share one grid of radii; a tooth
// whose tip is missing is drawn on as many of its own, and is whole on the common one.

import { modulo, TURN, UM } from "../../page/kit/data.js";

export class Gear {
  constructor(raw) {
    Object.assign(this, raw);
    this.z = raw.z;
    this.r_b = raw.r_b;
    this.root = raw.root;
    this.tau = TURN / raw.z;
    this.lines = raw.centre_lines;
    this.radius = raw.radius;
    this.psi = raw.psi;
    this.n = this.radius.length;
    this.sides = { drive: raw.drive, coast: raw.coast };
    // Length along the ideal flank from mid space, by which detail is chosen.
    this.arc = new Float64Array(this.n);
    for (let k = 1; k < this.n; k++) {
      const [r, s] = [this.radius[k - 1], this.radius[k]];
      this.arc[k] = this.arc[k - 1] + Math.hypot(s - r, 0.5 * (r + s) * (this.psi[k] - this.psi[k - 1]));
    }
    this.chipped = new Map(raw.chipped.map((one) => [one.tooth, one]));
    this.mean = { drive: this.meanDeviation("drive"), coast: this.meanDeviation("coast") };
    this.widest = this.magnificationLimit();
    this.made = new Map();
  }

  // Normal deviation in um of one side of a tooth at grid point k; positive is more material.
  deviation(side, tooth, k) {
    const { level, rest } = this.sides[side];
    return level[tooth] + rest[tooth * this.n + k];
  }

  // Mean over all teeth of one side's deviation in um, halfway up the involute.
  meanDeviation(side) {
    const middle = (this.root + this.n) >> 1;
    let sum = 0;
    for (let t = 0; t < this.z; t++) sum += this.deviation(side, t, middle);
    return sum / this.z;
  }

  // Angle of a side from its tooth's centre line. Magnified are deviations from the gear's mean: thickness allowances
  // are many times the rest and would make teeth cross before that shows.
  psiAt(side, tooth, k, K) {
    if (k === 0) return this.psi[0]; // mid space, which all share
    const mean = this.mean[side];
    return this.psi[k] + ((mean + K * (this.deviation(side, tooth, k) - mean)) * UM) / this.r_b;
  }

  // The same at point k of the tooth's own grid, which ends where the tooth does.
  angleAt(side, tooth, k, K) {
    const own = this.chipped.get(tooth);
    if (!own || k === 0) return this.psiAt(side, tooth, k, K);
    const mean = this.mean[side];
    const d = own[side].level[0] + own[side].rest[k];
    return own.psi[k] + ((mean + K * (d - mean)) * UM) / this.r_b;
  }

  // Radii in mm of that grid.
  radiiOf(tooth) {
    const own = this.chipped.get(tooth);
    return own ? own.radius : this.radius;
  }

  // Where a tooth ends, mm.
  tipOf(tooth) {
    return this.radiiOf(tooth)[this.n - 1];
  }

  // From this magnification on, flanks of a tooth cross or neighbours meet.
  magnificationLimit() {
    let limit = Infinity;
    const meet = (room, drive, coast) => {
      const at = (K) => room + ((K * (drive - this.mean.drive + coast - this.mean.coast)
        + this.mean.drive + this.mean.coast) * UM) / this.r_b;
      const slope = at(1) - at(0);
      if (slope < 0) limit = Math.min(limit, at(0) / -slope);
    };
    for (let t = 0; t < this.z; t++) {
      for (let k = this.root - 1; k < this.n; k += 8) {
        const of = (side, tooth) => this.deviation(side, modulo(tooth, this.z), k);
        meet(2 * this.psi[k], of("drive", t), of("coast", t));
        // Material of both neighbours fills a space: the same with its sign turned.
        const space = this.tau - 2 * this.psi[k];
        for (const next of [t - 1, t + 1]) {
          const [drive, coast] = [of("drive", t), of("coast", next)];
          meet(space - (2 * (this.mean.drive + this.mean.coast) * UM) / this.r_b,
            2 * this.mean.drive - drive, 2 * this.mean.coast - coast);
        }
      }
    }
    return limit;
  }

  // Both sides of all teeth with deviations magnified K times, about the axis of rotation at rotation 0.
  faces(side, K) {
    const key = `${side} ${K}`;
    if (!this.made.has(key)) {
      // One magnified set is enough; only the true one is kept for good.
      for (const old of this.made.keys()) {
        if (!old.endsWith(" 1") && !old.endsWith(` ${K}`)) this.made.delete(old);
      }
      this.made.set(key, new Faces(this, side, K));
    }
    return this.made.get(key);
  }
}

class Faces {
  constructor(gear, side, K) {
    const { n, z } = gear;
    const sign = side === "drive" ? 1 : -1;
    this.n = n;
    this.z = z;
    this.xy = new Float64Array(2 * n * z);
    this.r2 = new Float64Array(n * z);
    this.first = new Int32Array(z);
    for (let t = 0; t < z; t++) {
      const radius = gear.radiiOf(t);
      for (let k = 0; k < n; k++) {
        const angle = gear.lines[t] + sign * gear.angleAt(side, t, k, K);
        const x = radius[k] * Math.cos(angle) + gear.centre[0];
        const y = radius[k] * Math.sin(angle) + gear.centre[1];
        const at = t * n + k;
        this.xy[2 * at] = x;
        this.xy[2 * at + 1] = y;
        this.r2[at] = x * x + y * y;
      }
      // From here to the tip the radius about the axis rises; below lies root land, which an eccentricity tilts.
      let k = n - 1;
      while (k > 0 && this.r2[t * n + k - 1] < this.r2[t * n + k]) k--;
      this.first[t] = k;
    }
  }
}
