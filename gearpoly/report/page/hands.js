// What hands and keys do to a plot.

import { clamp } from "../../page/kit/data.js";
import { keys, pointers, wheel } from "../../page/kit/pointers.js";

const SCROLLING = 250; // ms within which wheel steps belong to one scroll of the page
let scrolled = -Infinity;
addEventListener("wheel", (event) => {
  if (!event.defaultPrevented) scrolled = event.timeStamp;
}, { passive: true });

export function hands(plot) {
  const { canvas } = plot.chart;
  const { left } = plot.room;
  const linear = (py) => plot.height(plot.y(py));
  /** @param {number[]} at */
  const point = ([px, py]) => plot.point(plot.x(px), plot.y(py));
  let tapped = -Infinity; // when a finger last tapped

  wheel(canvas, (at, factor, event) => {
    // Who scrolls the page past a plot does not want it zoomed, and a plot that shows everything lets the page go on.
    if (event.timeStamp - scrolled < SCROLLING || (factor > 1 && plot.whole && !event.ctrlKey)) return false;
    const tall = event.shiftKey || at[0] < left;
    const both = plot.options.both || event.ctrlKey;
    const x = plot.x(clamp(at[0], left, left + plot.inner.width));
    plot.zoom(tall && !both ? 1 : factor, tall || both ? factor : 1, x, linear(at[1]));
    point(at);
    return true;
  });
  pointers(canvas, {
    drag: (from, to, factor) => {
      plot.figure.classList.add("moving");
      const { width, height } = plot.inner;
      plot.pan((from[0] - to[0]) / width, (to[1] - from[1]) / height);
      if (factor !== 1) plot.zoom(1 / factor, plot.options.both ? 1 / factor : 1, plot.x(to[0]), linear(to[1]));
    },
    up: () => plot.figure.classList.remove("moving"),
    hover: point,
    leave: () => plot.point(null, null),
    tap: (at, event) => {
      // A tap of a finger shows the read-out, as a mouse does by standing there; two taps are a double click.
      if (event.pointerType !== "touch") return;
      point(at);
      if (event.timeStamp - tapped < 400) plot.reset();
      tapped = event.timeStamp;
    },
  });
  canvas.addEventListener("dblclick", () => plot.reset());
  keys(canvas, (event) => acts(plot, event.shiftKey)[event.key]);
}

function acts(plot, shift) {
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
