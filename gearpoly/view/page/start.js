// The page starts, compares its kernel with the simulation, and offers itself to scripts and tests.

import { DATA, DEG, modulo } from "../../page/kit/data.js";
import { element } from "../../page/kit/dom.js";
import { camera, drawn, frame, pair, recolour, recording, refresh, stage, state, view } from "./show.js";
import { followContact, magnify, playing, select, showWhole, toothAt, turnTo, zoomTo } from "./act.js";
import { controls, stageHands, stripHands } from "./hands.js";

// Frames per second while the gears turn and everything is drawn: `seconds` of it, `step` pitches a frame.
function measure(seconds, step = 0.01) {
  return new Promise((resolve) => {
    const times = [];
    let busy = 0;
    const begin = performance.now();
    const one = (now) => {
      times.push(now);
      view.theta_2 = modulo(view.theta_2 + step * pair.tau, pair.cycle);
      const start = performance.now();
      refresh(times.length % 2 === 0); // as frame() does
      busy += performance.now() - start;
      if (now - begin < 1000 * seconds) requestAnimationFrame(one);
      else {
        const gaps = times.slice(1).map((t, k) => t - times[k]).sort((a, b) => a - b);
        resolve({
          frames: gaps.length, fps: (1000 * gaps.length) / (times[times.length - 1] - times[0]),
          work_ms: busy / times.length, worst_ms: gaps[gaps.length - 1], p95_ms: gaps[Math.floor(0.95 * gaps.length)],
        });
      }
    };
    requestAnimationFrame(one);
  });
}

document.body.classList.toggle("recording", Boolean(recording));
controls();
stageHands();
stripHands();
recolour();
stage.fit();
camera.width = stage.width;
camera.height = stage.height;
showWhole();
playing();
magnify(1);
refresh();
const checked = pair.check();
// A tenth of what positions are promised to; the curves are the simulation's own in any case.
if (!(checked.te_um < 0.01 && checked.point_um < 0.1)) {
  const warning = element("warning");
  warning.hidden = false;
  warning.textContent =
    `Contacts shown here differ from the simulation by up to ${checked.te_um.toPrecision(2)} \u00b5m of TE and `
    + `${checked.point_um.toPrecision(2)} \u00b5m of place; trust simulate, and report this pair.`;
}
requestAnimationFrame(frame);

const gearpoly = {
  data: DATA,
  checked,
  // Everything about the pair at a driven angle in deg, without turning the picture.
  at: (deg, K = 1) => pair.solve(modulo(deg * DEG, pair.cycle), K),
  turn: (deg) => { turnTo(deg * DEG); refresh(); return state; },
  get state() { return state; },
  get drawn() { return drawn; },
  view,
  camera,
  screen: (x, y) => [camera.px(x), camera.py(y)],
  toothAt,
  follow: (which) => { followContact(which); refresh(); },
  zoomTo: (across) => { zoomTo(across); refresh(); },
  select,
  measure,
  recording,
  pair,
};
Object.assign(window, { gearpoly });
