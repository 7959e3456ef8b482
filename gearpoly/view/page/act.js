// What is done: turning, moving, following, choosing, magnifying.

import { clamp, DEG, modulo, TURN, UM } from "../../page/kit/data.js";
import { lowerBound } from "../../page/kit/charts.js";
import { element } from "../../page/kit/dom.js";
import { Panels } from "./panels.js";
import { camera, drawn, driven, driving, pair, recording, redraw, view, whenShown } from "./show.js";

export function say(text) { element("live").textContent = text; }

export function turnTo(theta_2) {
  view.theta_2 = modulo(theta_2, pair.cycle);
  redraw();
}

// Zoom about a place on the stage; a followed contact stays where it is when the place is the centre.
export function zoomAt(px, py, factor) {
  const before = camera.world(px, py);
  camera.scale = camera.limit(camera.scale * factor, widestView());
  const after = camera.world(px, py);
  move(before[0] - after[0], before[1] - after[1]);
}

function widestView() { return 2.6 * (driving.r_a + driven.r_a + pair.a); }

export function move(dx, dy) {
  if (view.follow) view.offset = [view.offset[0] + dx, view.offset[1] + dy];
  else {
    const slack = widestView();
    camera.x = clamp(camera.x + dx, -slack, slack);
    camera.y = clamp(camera.y + dy, -slack, slack);
  }
  redraw();
}

export function followContact(which) {
  view.follow = which;
  view.offset = [0, 0];
  element("follow").setAttribute("aria-pressed", String(Boolean(which)));
  redraw();
}

// `across` mm on the narrower side of the view.
export function zoomTo(across) {
  camera.scale = camera.limit(Math.min(camera.width, camera.height) / across, widestView());
  redraw();
}

export function showWhole() {
  followContact(null);
  const wide = driving.r_a + pair.a + driven.r_a, high = 2 * Math.max(driving.r_a, driven.r_a);
  const bar = Math.min(46, 0.2 * camera.height); // px that the buttons cover
  camera.scale = camera.limit(Math.min(camera.width / (1.06 * wide), (camera.height - bar) / (1.04 * high)), widestView());
  camera.x = 0.5 * (pair.a + driven.r_a - driving.r_a);
  camera.y = (0.5 * bar) / camera.scale;
  redraw();
}

/** @type {[string, () => void][]} */
export const PRESETS = [
  ["gears", showWhole],
  ["mesh", () => { followContact(null); camera.x = driving.r; camera.y = 0; zoomTo(6.5 * driving.m); }],
  ["tooth", () => { if (!view.follow) followContact("first"); view.offset = [0, 0]; zoomTo(1.6 * driving.m); }],
  ["micro", () => { if (!view.follow) followContact("first"); view.offset = [0, 0]; zoomTo(10 * UM); }],
  ["nano", () => { if (!view.follow) followContact("first"); view.offset = [0, 0]; zoomTo(10e-6); }],
];

export function select(gear, tooth) {
  view.selected = { gear, tooth };
  panels.tooth(pair.gears[gear], tooth);
  say(`${pair.gears[gear].name} tooth ${tooth} chosen`);
  redraw();
}

export function jump(theta_2) {
  view.playing = false;
  playing();
  turnTo(theta_2);
  say(`driven angle ${(view.theta_2 / DEG).toFixed(2)} degrees`);
}

// Driven angle of a notable place of the curves.
export function notable(what) {
  const values = {
    least: () => pair.curve.map((v) => -v),
    greatest: () => pair.curve,
    step: () => pair.curve.map((v, k) => Math.abs(pair.curve[(k + 1) % pair.size] - v)),
    backlash: () => pair.backlash.map((v) => -v),
    mismatch: () => recording.mismatch.map((v) => Math.abs(v - recording.mean_um)),
  }[what]();
  let most = 0;
  for (let k = 1; k < values.length; k++) if (values[k] > values[most]) most = k;
  if (what === "mismatch") return recording.theta_2[most];
  return (most + (what === "step" ? 0.5 : 0)) * pair.step;
}

// To where compare found a difference: the mesh of that tooth in which it is greatest, or that phase of this mesh.
function goTo(entry) {
  if (entry.tooth !== null) {
    const which = entry.gear === "driving" ? 0 : 1;
    let most = -1, target = null;
    for (let mesh = 0; mesh < pair.data.meshes; mesh++) {
      if (pair.teeth(mesh, pair.data.flank)[which] !== entry.tooth) continue;
      const phase = entry.phase || [-0.25, 0.25];
      const [low, high] = phase.map((part) => pair.angleOf(mesh) + part * pair.tau);
      const { mean, count } = recording.over(low, high);
      const size = count > 0 ? Math.abs(mean - recording.mean_um) : 0;
      if (size > most) {
        most = size;
        target = { mesh, theta_2: 0.5 * (low + high) };
      }
    }
    select(which, entry.tooth);
    const [i, j] = pair.teeth(target.mesh, pair.data.flank);
    followContact({ driving: i, driven: j });
    zoomTo(3 * driving.m);
    jump(target.theta_2);
  } else if (entry.phase) {
    jump(pair.angleOf(Math.round(view.theta_2 / pair.tau)) + 0.5 * (entry.phase[0] + entry.phase[1]) * pair.tau);
  }
}

// The tooth under a place on the stage: { gear, tooth }, or null beside both gears.
export function toothAt(px, py) {
  const [x, y] = camera.world(px, py);
  const turns = [drawn.theta_1, -view.theta_2];
  let body = null;
  for (const k of [0, 1]) {
    const gear = pair.gears[k];
    const [c, s] = [Math.cos(turns[k]), Math.sin(turns[k])];
    const u = x - (k === 0 ? 0 : pair.a);
    const bx = c * u + s * y - gear.centre[0], by = -s * u + c * y - gear.centre[1];
    const r = Math.hypot(bx, by);
    if (r > gear.r_a || r < gear.r_bore) continue;
    let tooth = 0, least = Infinity, off = 0;
    for (let t = 0; t < gear.z; t++) {
      const angle = modulo(Math.atan2(by, bx) - gear.lines[t] + Math.PI, TURN) - Math.PI;
      if (Math.abs(angle) < least) [tooth, least, off] = [t, Math.abs(angle), angle];
    }
    const at = clamp(lowerBound(gear.radiiOf(tooth), r), 0, gear.n - 1);
    const side = off >= 0 ? "drive" : "coast";
    const inside = r > gear.r_f && r <= gear.tipOf(tooth);
    if (inside && least <= gear.angleAt(side, tooth, at, drawn.magnify)) return { gear: k, tooth };
    if (r <= gear.r_f) body = { gear: k, tooth };
  }
  return body;
}

export function playing() {
  const button = element("play");
  button.setAttribute("aria-pressed", String(view.playing));
  button.textContent = view.playing ? "Pause" : "Play";
}

export function magnify(K) {
  view.magnify = K;
  element("magnify-value").textContent = `\u00d7${K < 10 ? Number(K.toFixed(1)) : Math.round(K)}`;
  element("magnify").setAttribute("aria-valuetext", `${K.toFixed(1)} times`);
  if (K > 1) {
    view.show.ideal = true;
    element("show-ideal").checked = true;
  }
  redraw();
}

const panels = new Panels(pair, recording, {
  follow: (one) => {
    followContact({ driving: one.driving, driven: one.driven });
    if (camera.across > 4 * driving.m) zoomTo(2 * driving.m);
  },
  jump,
  place: goTo,
});
whenShown((state, lead) => {
  panels.now(state);
  panels.contacts(state, lead);
});
