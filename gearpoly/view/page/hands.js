// Hands and keys: pointers on the canvases, keys everywhere, and the controls.

function pointers() {
  const canvas = element("stage");
  const down = new Map();
  let travelled = 0;
  const local = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, local(event));
    if (down.size === 1) travelled = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!down.has(event.pointerId)) return;
    const before = [...down.values()].map((at) => at.slice());
    const [was, is] = [down.get(event.pointerId), local(event)];
    travelled += Math.hypot(is[0] - was[0], is[1] - was[1]);
    down.set(event.pointerId, is);
    if (down.size === 1) {
      if (travelled > 3) move((was[0] - is[0]) / camera.scale, (is[1] - was[1]) / camera.scale);
      return;
    }
    const after = [...down.values()];
    const middle = (points) => [0.5 * (points[0][0] + points[1][0]), 0.5 * (points[0][1] + points[1][1])];
    const apart = (points) => Math.hypot(points[0][0] - points[1][0], points[0][1] - points[1][1]);
    const [from, to] = [middle(before), middle(after)];
    move((from[0] - to[0]) / camera.scale, (to[1] - from[1]) / camera.scale);
    zoomAt(to[0], to[1], apart(after) / Math.max(1, apart(before)));
  });
  const up = (event) => {
    if (!down.delete(event.pointerId) || event.type !== "pointerup") return;
    if (down.size === 0 && travelled <= 5) {
      const hit = toothAt(...local(event));
      if (hit) select(hit.gear, hit.tooth);
    }
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    const [px, py] = local(event);
    // A followed contact is what one zooms in on.
    const at = view.follow ? [0.5 * camera.width, 0.5 * camera.height] : [px, py];
    zoomAt(at[0], at[1], Math.exp(-0.0022 * clamp(event.deltaY * lines, -400, 400)));
  }, { passive: false });
  for (const chart of [strips.whole, strips.near]) {
    let start = null;
    chart.canvas.addEventListener("pointerdown", (event) => {
      chart.canvas.setPointerCapture(event.pointerId);
      const x = event.clientX - chart.canvas.getBoundingClientRect().left;
      start = { x, theta_2: view.theta_2 };
      if (chart === strips.whole) turnTo(strips.angleAt(chart, x, view.theta_2));
    });
    chart.canvas.addEventListener("pointermove", (event) => {
      if (!start) return;
      const x = event.clientX - chart.canvas.getBoundingClientRect().left;
      if (chart === strips.whole) turnTo(Math.min(strips.angleAt(chart, x, 0), pair.cycle - 1e-9));
      else {
        // The curve goes with the hand.
        const span = chart.width - strips.left - strips.right;
        turnTo(start.theta_2 - ((x - start.x) / span) * 2 * AROUND * pair.tau);
        start.moved = start.moved || Math.abs(x - start.x) > 3;
      }
    });
    const end = (event) => {
      if (start && !start.moved && chart === strips.near && event.type === "pointerup") {
        turnTo(strips.angleAt(chart, start.x, start.theta_2));
      }
      start = null;
    };
    chart.canvas.addEventListener("pointerup", end);
    chart.canvas.addEventListener("pointercancel", end);
  }
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

function controls() {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event;
    if (target instanceof HTMLSelectElement || (target instanceof HTMLInputElement && target.type === "number")) return;
    if (element("help").open) return;
    const digit = "12345".indexOf(event.key);
    if (digit >= 0 && event.key.length === 1) PRESETS[digit][1]();
    else if (event.key in KEYS) KEYS[event.key]();
    else if (target === element("stage") && event.key.startsWith("Arrow")) {
      const step = (event.shiftKey ? 160 : 40) / camera.scale;
      const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      move(dx * step, dy * step);
    } else return;
    event.preventDefault();
  });
  const cycle = element("cycle");
  cycle.max = String(pair.cycle / DEG);
  cycle.step = "any";
  cycle.addEventListener("input", () => turnTo(Math.min(cycle.valueAsNumber * DEG, pair.cycle * (1 - 1e-12))));
  // Browsers step an "any" slider by whole units; a sample is what one wants.
  cycle.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    const meshes = { PageDown: -1, PageUp: 1 }[event.key];
    if (steps) turnTo(view.theta_2 + steps * (event.shiftKey ? 0.01 : 1) * pair.step);
    else if (meshes) turnTo(view.theta_2 + meshes * pair.tau);
    else return;
    event.preventDefault();
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
  element("speed").addEventListener("change", (event) => { view.speed = Number(event.target.value); });
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
  element("gap-range").addEventListener("change", (event) => {
    view.gapRange = Number(event.target.value);
    redraw();
  });
  if (recording) element("goto").querySelector("[value=mismatch]").hidden = false;
  element("goto").addEventListener("change", (event) => {
    jump(notable(event.target.value));
    event.target.value = "";
  });
  element("help-open").addEventListener("click", () => element("help").showModal());
  element("theme").addEventListener("change", (event) => {
    const { value } = event.target;
    if (value === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = value;
    colours = readColours();
    redraw();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    colours = readColours();
    redraw();
  });
  new ResizeObserver(redraw).observe(element("stage"));
  new ResizeObserver(redraw).observe(element("whole"));
}
