// What is seen: the pair at the chosen angle, drawn and put into words.

import { DATA, DEG, lengthText, modulo, placesOf, signed, UM } from "../../page/kit/data.js";
import { Chart, lowerBound } from "../../page/kit/charts.js";
import { element } from "../../page/kit/dom.js";
import { Pair } from "./pair.js";
import { Camera } from "./camera.js";
import { Picture } from "./picture.js";
import { Overlay } from "./overlay.js";
import { Strips } from "./strips.js";
import { FlankCharts } from "./flanks.js";

class Recording {
  constructor(raw, pair) {
    Object.assign(this, raw);
    this.mean_um = raw.mean_um;
    this.pair = pair;
    this.theta_2 = placesOf(raw.theta_2);
    this.recorded = raw.recorded_um;
    this.mismatch = raw.mismatch_um;
    // Pitches about the cursor over which the mismatch is averaged: a sample of the simulation, or three recorded ones.
    this.window = Math.min(0.5, Math.max(1 / 40, (3 * pair.data.meshes) / this.theta_2.length));
  }

  // Mean mismatch and number of samples between two angles, which may reach past the cycle's ends.
  over(low, high) {
    let sum = 0, count = 0;
    for (const shift of [-this.pair.cycle, 0, this.pair.cycle]) {
      const to = lowerBound(this.theta_2, high - shift);
      for (let k = lowerBound(this.theta_2, low - shift); k < to; k++, count++) sum += this.mismatch[k];
    }
    return { mean: count > 0 ? sum / count : NaN, count };
  }
}

export const pair = new Pair(DATA);
export const recording = DATA.recording ? new Recording(DATA.recording, pair) : null;
export const camera = new Camera();
const picture = new Picture(camera);
const overlay = new Overlay(camera, picture, pair);
export const stage = new Chart(element("stage"));
export const strips = new Strips(element("whole"), element("near"), pair, recording);
const charts = new FlankCharts(element("gaps"), element("tooth-chart"), pair);
export const [driving, driven] = pair.gears;

export const view = {
  theta_2: DATA.at,
  magnify: 1,
  follow: null, // null: the view stands; else { driving, driven, mesh } or "first"
  offset: [0, 0], // of the view's centre from the followed contact, mm
  selected: null, // { gear, tooth }
  playing: false,
  speed: 0.5, // pitches per second
  show: { ideal: false, normals: true, numbers: true, circles: true, action: true, coast: false, load: true },
  gapRange: 20,
};
export let state = null; // the true pair at view.theta_2
export let drawn = null; // the same, or the exaggerated or unloaded pair
let dirty = true;
let colours = null;

function readColours() {
  const style = getComputedStyle(document.documentElement);
  const of = (name) => style.getPropertyValue(`--${name}`).trim();
  const gear = (name) => ({ fill: of(`${name}-fill`), line: of(name), selected: of(`${name}-selected`) });
  return {
    ink: of("ink"), muted: of("muted"), halo: of("stage"), line: of("rule"), guide: of("guide"), panel: of("panel"),
    touch: of("touch"), normal: of("normal"), force: of("force"), action: of("action"), curve: of("curve"),
    miss: of("miss"), recorded: of("recorded"), cursor: of("cursor"), window: of("window"),
    driving: gear("driving"), driven: gear("driven"),
  };
}

export function recolour() { colours = readColours(); }

function solve() {
  state = pair.solve(view.theta_2);
  if (!state) return;
  state.curve_um = pair.interpolated(pair.curve, view.theta_2);
  const plain = view.magnify === 1 && (view.show.load || !pair.loaded);
  drawn = plain ? state : pair.solve(view.theta_2, view.magnify, view.show.load) || state;
  if (recording) {
    const half = 0.5 * recording.window * pair.tau;
    const { mean, count } = recording.over(view.theta_2 - half, view.theta_2 + half);
    state.miss = mean;
    state.count = count;
  }
}

export function followed(solution) {
  if (!view.follow || !solution) return null;
  if (view.follow === "first") return solution.contacts[0];
  return solution.contacts.find((one) => one.driving === view.follow.driving && one.driven === view.follow.driven)
    || solution.contacts[0];
}

function place() {
  const one = followed(drawn);
  if (one) {
    camera.x = one.point[0] + view.offset[0];
    camera.y = one.point[1] + view.offset[1];
  }
}

// Gears and cursors; with `all` the curves beside them too, which may lag a frame while everything moves.
function draw(all) {
  stage.fit();
  camera.width = stage.width;
  camera.height = stage.height;
  place();
  const { context } = stage;
  stage.clear(colours.halo);
  const turns = [drawn.theta_1, -view.theta_2];
  if (view.show.circles) overlay.circles(context, turns, colours);
  const seen = pair.gears.map((gear, k) => {
    const selected = view.selected && view.selected.gear === k ? view.selected.tooth : -1;
    const axis = k === 0 ? 0 : pair.a;
    const teeth = picture.gear(context, gear, axis, turns[k], drawn.magnify, colours[gear.name], selected);
    if (view.show.ideal) picture.ideal(context, gear, axis, turns[k], teeth, drawn.magnify, colours[gear.name].line);
    return teeth;
  });
  if (view.show.action) overlay.lineOfAction(context, colours);
  if (view.show.numbers) {
    pair.gears.forEach((gear, k) => {
      const selected = view.selected && view.selected.gear === k ? view.selected.tooth : -1;
      overlay.numbers(context, gear, k === 0 ? 0 : pair.a, turns[k], seen[k], colours, selected);
    });
  }
  const pose = { theta_1: drawn.theta_1, normals: view.show.normals };
  const lead = followed(drawn);
  const marks = drawn.contacts.map((one) => overlay.contact(context, one, pose, one === lead, colours));
  const truth = state.contacts.slice();
  if (view.show.coast && drawn.other && state.other && state.backlash_um !== null) {
    // The other flank's pairs close once the backlash is used up.
    const apart = (one, solution) => ({ ...one, touching: false, gap_um: one.gap_um + Math.abs(solution.backlash_um) });
    truth.push(...state.other.contacts.map((one) => apart(one, state)));
    for (const one of drawn.other.contacts.slice(0, 3)) {
      marks.push(overlay.contact(context, apart(one, drawn), pose, false, colours));
    }
  }
  overlay.labels(context, marks.filter((mark) => mark), truth, colours);
  overlay.scaleBar(context, colours);
  strips.drawWhole(view.theta_2, colours);
  if (!all) return;
  strips.drawNear(state, colours);
  charts.drawGaps(state, view.gapRange, followed(state), colours);
  if (view.selected) {
    const gear = pair.gears[view.selected.gear];
    const mine = state.contacts.filter((one) => (view.selected.gear === 0 ? one.driving : one.driven) === view.selected.tooth);
    const levels = charts.drawTooth(gear, view.selected.tooth, mine, colours);
    element("tooth-levels").textContent =
      `solid: drive flank about its mean of ${signed(levels[0], 2)} \u00b5m; dashed: coast flank about ${signed(levels[1], 2)} \u00b5m`;
  }
}

const told = []; // what else puts the state into words

export function whenShown(act) { told.push(act); }

function words() {
  for (const act of told) act(state, followed(state));
  const cycle = element("cycle"), fine = element("fine"), angle = element("angle");
  const text = `${(view.theta_2 / DEG).toFixed(4)} degrees`;
  if (document.activeElement !== cycle || view.playing || Math.abs(cycle.valueAsNumber * DEG - view.theta_2) > 1e-9) {
    cycle.value = String(view.theta_2 / DEG);
  }
  cycle.setAttribute("aria-valuetext", text);
  const share = view.theta_2 / pair.tau - Math.floor(view.theta_2 / pair.tau + 1e-12);
  if (document.activeElement !== fine || view.playing) fine.value = String(share);
  fine.setAttribute("aria-valuetext", `${share.toFixed(3)} of a pitch`);
  if (document.activeElement !== angle) angle.value = (view.theta_2 / DEG).toFixed(5);
  element("across").textContent = lengthText(camera.across);
  element("banner").hidden = view.magnify === 1;
  const overlap = element("overlap");
  overlap.hidden = !(drawn.approach_um > 0 && view.magnify === 1 && camera.across < 200 * UM);
  overlap.textContent = `Teeth are drawn rigid: under load they overlap by ${state.approach_um.toFixed(3)} \u00b5m, which is what they give way.`;
}

let last = 0;
let moving = false; // the frame before was drawn too
let owed = false; // curves and words lag the picture
export function frame(now) {
  const elapsed = Math.min(0.1, (now - last) / 1000);
  last = now;
  if (view.playing) {
    view.theta_2 = modulo(view.theta_2 + view.speed * pair.tau * elapsed, pair.cycle);
    dirty = true;
  }
  if (dirty || owed) {
    const all = owed || !moving;
    moving = dirty;
    dirty = false;
    owed = !all;
    refresh(all);
  } else {
    moving = false;
  }
  requestAnimationFrame(frame);
}

export function refresh(all = true) {
  solve();
  element("lost").hidden = Boolean(state);
  if (!state) return;
  draw(all);
  if (all) words();
}

export function redraw() { dirty = true; }
