// What hands do, the same on every page: pointers that drag, pinch and tap, the wheel, and keys.

const TAP = 6; // px that a pointer may move between down and up and still mean the place that it came down on
const TOUCH = 8; // px, the same for a finger

// Place of an event on an element, px.
function local(node, event) {
  const box = node.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

// Middle of all pointers that are down, and how far two of them are apart.
function span(down) {
  const all = [...down.values()];
  if (all.length === 0) return null;
  const x = all.reduce((sum, one) => sum + one[0], 0) / all.length;
  const y = all.reduce((sum, one) => sum + one[1], 0) / all.length;
  const apart = all.length > 1 ? Math.hypot(all[0][0] - all[1][0], all[0][1] - all[1][1]) : 0;
  return { x, y, apart };
}

/**
 * Pointers on a canvas. `down(at)` is the first that comes down, `drag(from, to, factor, begin)` a move of the middle of
 * all, by `factor` farther apart, since the first came down at `begin`; `tap(at, event)` one that went up where it came
 * down, `hover(at)` one that is not down, `leave()` and `up()` none that is.
 * @param {HTMLCanvasElement} canvas
 * @param {{down?: Function, drag?: Function, tap?: Function, hover?: Function, leave?: Function, up?: Function}} acts
 */
export function pointers(canvas, { down, drag, tap, hover, leave, up }) {
  const held = new Map(); // places by pointer
  let before = null; // the middle at the last move
  let begin = null; // where the first came down, while it may be a tap
  const near = (at, event) => Math.hypot(at[0] - begin[0], at[1] - begin[1]) <= (event.pointerType === "touch" ? TOUCH : TAP);
  let still = false; // nothing but a tap so far
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    const at = local(canvas, event);
    held.set(event.pointerId, at);
    before = span(held);
    still = held.size === 1;
    if (!still) return;
    begin = at;
    down?.(at);
  });
  canvas.addEventListener("pointermove", (event) => {
    const at = local(canvas, event);
    if (!held.has(event.pointerId)) {
      hover?.(at);
      return;
    }
    held.set(event.pointerId, at);
    still = still && near(at, event);
    const now = span(held);
    const factor = before.apart > 0 ? now.apart / Math.max(1, before.apart) : 1;
    drag?.([before.x, before.y], [now.x, now.y], factor, begin);
    before = now;
  });
  const end = (event) => {
    if (!held.delete(event.pointerId)) return;
    before = span(held);
    if (held.size > 0) return;
    up?.();
    if (event.type === "pointerup" && still) tap?.(local(canvas, event), event);
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "mouse" && held.size === 0) leave?.();
  });
}

/**
 * The wheel on a canvas: `act(at, factor, event)` gets by how much more to show, below 1 for less; it gives false where
 * the page shall scroll.
 * @param {HTMLCanvasElement} canvas
 * @param {(at: number[], factor: number, event: WheelEvent) => boolean | void} act
 */
export function wheel(canvas, act) {
  canvas.addEventListener("wheel", (event) => {
    const px = (event.deltaY || event.deltaX) * (event.deltaMode === 1 ? 16 : 1);
    const factor = Math.exp(0.002 * Math.min(300, Math.max(-300, px)));
    if (act(local(canvas, event), factor, event) !== false) event.preventDefault();
  }, { passive: false });
}

/**
 * Keys without Ctrl, Alt and Meta: `find(event)` gives what one does, or nothing where it is the browser's.
 * @param {HTMLElement | Document} node
 * @param {(event: KeyboardEvent) => (() => void) | undefined} find
 */
export function keys(node, find) {
  node.addEventListener("keydown", (/** @type {any} */ event) => {
    const act = event.ctrlKey || event.metaKey || event.altKey ? undefined : find(event);
    if (!act) return;
    event.preventDefault();
    act();
  });
}
