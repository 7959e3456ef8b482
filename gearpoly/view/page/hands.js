// Hands and keys: pointers on the canvases, keys everywhere, and the controls.

import { DEG } from "../../page/kit/data.js";
import { element, themes } from "../../page/kit/dom.js";
import { keys, pointers, wheel } from "../../page/kit/pointers.js";
import { AROUND } from "./strips.js";
import { camera, followed, pair, recolour, recording, redraw, state, strips, view } from "./show.js";
import {
  followContact, jump, magnify, move, notable, playing, PRESETS, say, select, showWhole, toothAt, turnTo, zoomAt,
} from "./act.js";

export function stageHands() {
  const canvas = element("stage");
  pointers(canvas, {
    drag: (from, to, factor, begin) => {
      // What may still be a click on a tooth moves nothing.
      if (factor === 1 && Math.hypot(to[0] - begin[0], to[1] - begin[1]) <= 3) return;
      move((from[0] - to[0]) / camera.scale, (to[1] - from[1]) / camera.scale);
      if (factor !== 1) zoomAt(to[0], to[1], factor);
    },
    tap: (at) => {
      const hit = toothAt(at[0], at[1]);
      if (hit) select(hit.gear, hit.tooth);
    },
  });
  wheel(canvas, (at, factor) => {
    // A followed contact is what one zooms in on.
    const [px, py] = view.follow ? [0.5 * camera.width, 0.5 * camera.height] : at;
    zoomAt(px, py, 1 / factor);
  });
}

export function stripHands() {
  const { whole, near } = strips;
  const goTo = (at) => turnTo(Math.min(strips.angleAt(whole, at[0], 0), pair.cycle - 1e-9));
  pointers(whole.canvas, { down: goTo, drag: (from, to) => goTo(to) });
  // The curve goes with the hand.
  let start = 0;
  pointers(near.canvas, {
    down: () => { start = view.theta_2; },
    drag: (from, to, factor, begin) => {
      const span = near.width - strips.left - strips.right;
      turnTo(start - ((to[0] - begin[0]) / span) * 2 * AROUND * pair.tau);
    },
    tap: (at) => turnTo(strips.angleAt(near, at[0], start)),
  });
}

const KEYS = {
  "[": () => turnTo(view.theta_2 - pair.step), "]": () => turnTo(view.theta_2 + pair.step),
  "{": () => turnTo(view.theta_2 - pair.tau), "}": () => turnTo(view.theta_2 + pair.tau),
  ",": () => turnTo(view.theta_2 - 0.01 * pair.step), ".": () => turnTo(view.theta_2 + 0.01 * pair.step),
  "+": () => zoomAt(0.5 * camera.width, 0.5 * camera.height, 1.5),
  "=": () => zoomAt(0.5 * camera.width, 0.5 * camera.height, 1.5),
  "-": () => zoomAt(0.5 * camera.width, 0.5 * camera.height, 1 / 1.5),
  "0": showWhole,
  f: () => element("follow").click(),
  n: () => nextPair(),
  p: () => element("play").click(),
  "?": () => element("help").showModal(),
};

// Follows the next near pair, first touch first.
function nextPair() {
  const all = state.contacts;
  const at = all.indexOf(followed(state));
  const one = all[(at + 1) % all.length];
  followContact({ driving: one.driving, driven: one.driven });
  say(`following driving tooth ${one.driving} on driven tooth ${one.driven}`);
}

export function controls() {
  keys(document, (event) => {
    const { target } = event;
    if (target instanceof HTMLSelectElement || (target instanceof HTMLInputElement && target.type === "number")) return undefined;
    if (element("help").open) return undefined;
    const digit = event.key.length === 1 ? "12345".indexOf(event.key) : -1;
    if (digit >= 0) return PRESETS[digit][1];
    if (event.key in KEYS) return KEYS[event.key];
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (target !== element("stage") || !way) return undefined;
    const step = (event.shiftKey ? 160 : 40) / camera.scale;
    return () => move(way[0] * step, way[1] * step);
  });
  const cycle = element("cycle");
  cycle.max = String(pair.cycle / DEG);
  cycle.step = "any";
  cycle.addEventListener("input", () => turnTo(Math.min(cycle.valueAsNumber * DEG, pair.cycle * (1 - 1e-12))));
  // Browsers step an "any" slider by whole units; a sample is what one wants.
  keys(cycle, (event) => {
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    const meshes = { PageDown: -1, PageUp: 1 }[event.key];
    if (steps) return () => turnTo(view.theta_2 + steps * (event.shiftKey ? 0.01 : 1) * pair.step);
    return meshes ? () => turnTo(view.theta_2 + meshes * pair.tau) : undefined;
  });
  const fine = element("fine");
  fine.addEventListener("input", () => {
    const mesh = Math.floor(view.theta_2 / pair.tau + 1e-12);
    turnTo((mesh + Math.min(fine.valueAsNumber, 1 - 1e-9)) * pair.tau);
  });
  const angle = element("angle");
  angle.addEventListener("change", () => {
    if (Number.isFinite(angle.valueAsNumber)) turnTo(angle.valueAsNumber * DEG);
  });
  element("play").addEventListener("click", () => {
    view.playing = !view.playing;
    playing();
    redraw();
  });
  element("speed").addEventListener("change", () => { view.speed = Number(element("speed").value); });
  element("follow").addEventListener("click", () => followContact(view.follow ? null : "first"));
  PRESETS.forEach(([name, act]) => element(`zoom-${name}`).addEventListener("click", act));
  for (const name of Object.keys(view.show)) {
    const box = element(`show-${name}`);
    box.checked = view.show[name];
    box.addEventListener("change", () => {
      view.show[name] = box.checked;
      redraw();
    });
  }
  element("show-load").parentElement.hidden = !pair.loaded;
  const most = Math.min(1000, 0.9 * pair.widest);
  const slider = element("magnify");
  if (most <= 1) slider.disabled = true;
  slider.addEventListener("input", () => magnify(Math.max(1, most) ** slider.valueAsNumber));
  element("crossing").textContent = Number.isFinite(pair.widest) && pair.widest < 1100
    ? `teeth would cross at \u00d7${Math.floor(pair.widest)}` : "";
  element("gap-range").addEventListener("change", () => {
    view.gapRange = Number(element("gap-range").value);
    redraw();
  });
  const places = element("goto");
  if (recording) places.querySelector("[value=mismatch]").hidden = false;
  places.addEventListener("change", () => {
    jump(notable(places.value));
    places.value = "";
  });
  element("help-open").addEventListener("click", () => element("help").showModal());
  themes(() => {
    recolour();
    redraw();
  });
  new ResizeObserver(redraw).observe(element("stage"));
  new ResizeObserver(redraw).observe(element("whole"));
}
