// What hands and keys do to a plot.

const SCROLLING = 250; // ms within which wheel steps belong to one scroll of the page
let scrolled = -Infinity;
addEventListener("wheel", (event) => {
  if (!event.defaultPrevented) scrolled = event.timeStamp;
}, { passive: true });

function hands(plot) {
  const { canvas } = plot.chart;
  const down = new Map(); // pointers on the canvas by id
  let before = null; // what the pointers were at the last move
  let tapped = -Infinity; // when a finger last tapped
  let tap = null; // where and when a finger came down that may be a tap
  const local = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const linear = (py) => plot.height(plot.y(py));

  canvas.addEventListener("wheel", (event) => {
    // Who scrolls the page past a plot does not want it zoomed, and a plot that shows everything lets the page go on.
    const out = (event.deltaY || event.deltaX) > 0;
    if (event.timeStamp - scrolled < SCROLLING || (out && plot.whole && !event.ctrlKey)) return;
    event.preventDefault();
    const [px, py] = local(event);
    const lines = event.deltaMode === 1 ? 16 : 1;
    const factor = Math.exp(clamp((event.deltaY || event.deltaX) * lines, -300, 300) * 0.002);
    const tall = event.shiftKey || px < ROOM.left;
    const both = plot.options.both || event.ctrlKey;
    plot.zoom(tall && !both ? 1 : factor, tall || both ? factor : 1, plot.x(clamp(px, ROOM.left, ROOM.left + plot.inner.width)), linear(py));
    plot.point(plot.x(px), plot.y(py));
  }, { passive: false });

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, local(event));
    before = span(down);
    tap = event.pointerType === "touch" && down.size === 1 ? { at: local(event), since: event.timeStamp } : null;
  });
  canvas.addEventListener("pointermove", (event) => {
    const [px, py] = local(event);
    if (!down.has(event.pointerId)) {
      plot.point(plot.x(px), plot.y(py));
      return;
    }
    down.set(event.pointerId, [px, py]);
    const now = span(down);
    plot.figure.classList.add("moving");
    const { width, height } = plot.inner;
    plot.pan((before.x - now.x) / width, (now.y - before.y) / height);
    if (down.size > 1 && before.apart > 0) {
      const factor = before.apart / Math.max(now.apart, 1);
      plot.zoom(factor, plot.options.both ? factor : 1, plot.x(now.x), linear(now.y));
    }
    before = now;
  });
  const up = (event) => {
    down.delete(event.pointerId);
    before = span(down);
    if (down.size === 0) plot.figure.classList.remove("moving");
  };
  canvas.addEventListener("pointerup", (event) => {
    // A tap of a finger shows the read-out, as a mouse does by standing there; two taps are a double click.
    const [px, py] = local(event);
    if (tap && Math.hypot(px - tap.at[0], py - tap.at[1]) < 8 && event.timeStamp - tap.since < 400) {
      plot.point(plot.x(px), plot.y(py));
      if (event.timeStamp - tapped < 400) plot.reset();
      tapped = event.timeStamp;
    }
    tap = null;
    up(event);
  });
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "mouse" && down.size === 0) plot.point(null, null);
  });
  canvas.addEventListener("dblclick", () => plot.reset());
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const act = keys(plot, event.shiftKey)[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}

// Middle of the pointers and their distance.
function span(down) {
  const all = [...down.values()];
  if (all.length === 0) return null;
  const x = all.reduce((sum, one) => sum + one[0], 0) / all.length;
  const y = all.reduce((sum, one) => sum + one[1], 0) / all.length;
  const apart = all.length > 1 ? Math.hypot(all[0][0] - all[1][0], all[0][1] - all[1][1]) : 0;
  return { x, y, apart };
}

function keys(plot, shift) {
  const both = plot.options.both;
  const about = () => plot.cross?.x ?? 0.5 * (plot.view.x0 + plot.view.x1);
  const readAt = ({ x, y }) => {
    plot.point(x, y);
    const { x0, x1 } = plot.view;
    if (x < x0 || x > x1) plot.pan((x - 0.5 * (x0 + x1)) / (x1 - x0), 0);
  };
  const move = (sign) => readAt(plot.options.step(plot, about(), sign));
  return {
    "+": () => plot.zoom(0.8, both ? 0.8 : 1, about()),
    "=": () => plot.zoom(0.8, both ? 0.8 : 1, about()),
    "-": () => plot.zoom(1.25, both ? 1.25 : 1, about()),
    ArrowLeft: () => plot.pan(-0.1, 0),
    ArrowRight: () => plot.pan(0.1, 0),
    ArrowUp: () => (shift ? plot.zoom(1, 0.8) : plot.pan(0, 0.1)),
    ArrowDown: () => (shift ? plot.zoom(1, 1.25) : plot.pan(0, -0.1)),
    0: () => plot.reset(),
    Home: () => plot.reset(),
    f: () => plot.fitHeight(),
    ",": () => move(-1),
    ".": () => move(1),
    Escape: () => plot.point(null, null),
  };
}
