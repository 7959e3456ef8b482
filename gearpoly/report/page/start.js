// The page's plots, the recording that they show, and what scripts and tests may ask.

import { DATA, modulo, placesOf, signed } from "../../page/kit/data.js";
import { element, themes } from "../../page/kit/dom.js";
import { Curve } from "./levels.js";
import { colour, forgetColours, ROOM } from "./plot.js";
import { curvePlot, mapPlot, teethPlot } from "./painters.js";

const [z1, z2] = DATA.z;
const open = DATA.numbered.map((told) => (told ? "" : " (numbering open)"));
const made = new Map(); // what has been made ready to draw, by recording
let chosen = 0;

function recording() {
  if (!made.has(chosen)) {
    const raw = DATA.recordings[chosen];
    const { curves, spectrum } = raw;
    const read = (part, names) => Object.fromEntries(names.map((name) => [name, new Curve(part[name])]));
    made.set(chosen, {
      raw,
      places: placesOf(curves.x),
      curves: read(curves, ["recorded", "simulated_before", "simulated_after", "residual_before", "residual_after"]),
      orders: placesOf(spectrum.x),
      spectrum: read(spectrum, ["before", "after", "limit"]),
      maps: Object.fromEntries(["before", "after"].flatMap((when) => ["driving", "driven"].map((gear) => [
        `${gear}-${when}`, raw.maps[when][gear],
      ]))),
    });
  }
  return made.get(chosen);
}

const BEFORE = { colour: "--before", width: 1.2 }, AFTER = { colour: "--after", width: 1.5 };

// The angle, and which teeth stand where on the flank that was recorded.
function angleText(deg) {
  const coast = recording().raw.coast;
  const u = (deg / 360) * z2 - (coast ? 0.5 : 0);
  const n = Math.round(u);
  const numbers = [modulo(n, z1), modulo(n + (coast ? 1 : 0), z2)].map((k, gear) => (DATA.numbered[gear] ? k : "?"));
  const teeth = DATA.numbered.some((told) => told) ? `driving tooth ${numbers[0]} on driven ${numbers[1]}, ` : "";
  return `driven ${signed(deg, 3)}\u00b0 (${teeth}phase ${signed(u - n, 2)})`;
}

// An order of the driving shaft by what it is a whole order of.
function orderText(order) {
  const names = [[order / z1, "mesh"], [order, "driving shaft"], [(order * z2) / z1, "driven shaft"]]
    .filter(([v]) => Math.round(v) > 0 && Math.abs(v - Math.round(v)) < 0.03)
    .map(([v, name]) => `${name} order ${Math.round(v)}`);
  return `order ${order.toFixed(3)}${names.length ? ` (${names.join(", ")})` : ""}`;
}

const te = curvePlot(element("plot-te"), {
  title: "Transmission error over the driven angle, recorded and simulated before and after",
  xLabel: "driven angle / deg", yLabel: "transmission error / \u00b5m", least: [360 / z2 / 20, 0.02], readX: angleText,
  source: () => {
    const { places, curves, raw } = recording();
    return {
      places, gap: raw.curves.gap,
      curves: [
        { name: "recorded", label: "recorded", colour: "--recorded", curve: curves.recorded, width: 3 },
        { name: "simulated_before", label: "simulated before", ...BEFORE, curve: curves.simulated_before },
        { name: "simulated_after", label: "simulated after", ...AFTER, width: 1.2, curve: curves.simulated_after },
      ],
    };
  },
});

const residual = curvePlot(element("plot-residual"), {
  title: "Residual over the driven angle before and after",
  xLabel: "driven angle / deg", yLabel: "residual / \u00b5m", least: [360 / z2 / 20, 0.02], readX: angleText,
  source: () => {
    const { places, curves, raw } = recording();
    return {
      places, gap: raw.curves.gap,
      // The noise floor: two of three samples of pure noise lie in this band.
      under: (plot) => {
        const { context } = plot.chart;
        context.globalAlpha = 0.12;
        context.fillStyle = colour("--noise");
        const top = plot.py(raw.noise_um);
        context.fillRect(ROOM.left, top, plot.inner.width, plot.py(-raw.noise_um) - top);
        context.globalAlpha = 1;
      },
      curves: [
        { name: "residual_before", label: "before", ...BEFORE, curve: curves.residual_before },
        { name: "residual_after", label: "after", ...AFTER, width: 1.2, curve: curves.residual_after },
      ],
    };
  },
});
te.friends = [residual];
residual.friends = [te];

const spectrum = curvePlot(element("plot-spectrum"), {
  title: "Order spectrum of the residual before and after",
  xLabel: `order of the driving shaft (marks: mesh orders, ${z1} each)`, yLabel: "amplitude / \u00b5m", log: true,
  least: [0.2, 0.3], readX: orderText,
  source: () => {
    const { orders, spectrum: found } = recording();
    const [least] = found.limit.extent();
    return {
      places: orders, from: 0, floor: least / 10,
      under: (plot) => {
        const { context } = plot.chart;
        context.strokeStyle = colour("--guide");
        context.setLineDash([2, 3]);
        context.beginPath();
        for (let order = z1; order <= plot.view.x1; order += z1) {
          context.moveTo(plot.px(order), ROOM.top);
          context.lineTo(plot.px(order), ROOM.top + plot.inner.height);
        }
        context.stroke();
        context.setLineDash([]);
      },
      curves: [
        { name: "before", label: "before", ...BEFORE, curve: found.before },
        { name: "after", label: "after", ...AFTER, width: 1.2, curve: found.after },
        { name: "limit", label: "noise", colour: "--noise", curve: found.limit, dash: [6, 4] },
      ],
    };
  },
});

const GEARS = ["driving", "driven"];
const WHEN = ["before", "after"];

// Greatest value of a map, but three standard errors at least: below, colours would only show noise.
function topOf(gear, when) {
  const { maps, raw } = recording();
  let top = 3 * raw.maps[when].std[GEARS.indexOf(gear)];
  for (const value of maps[`${gear}-${when}`]) if (Math.abs(value) > top) top = Math.abs(value);
  return Math.max(top, 1e-3);
}

const maps = GEARS.flatMap((gear, k) => WHEN.map((when) => mapPlot(element(`map-${gear}-${when}`), {
  title: `Residual by tooth and mesh phase of the ${gear} gear, ${when}`,
  yLabel: `${gear} tooth${open[k]}`, rows: DATA.z[k],
  source: () => {
    const { maps: found, raw } = recording();
    const values = found[`${gear}-${when}`];
    const scale = element("scale").value;
    const gears = scale === "all" ? GEARS : [gear], times = scale === "own" ? [when] : WHEN;
    return {
      values, cells: values.length / DATA.z[k], std: raw.maps[when].std[k], marked: DATA.built[k].marked,
      top: Math.max(...gears.flatMap((g) => times.map((w) => topOf(g, w)))),
    };
  },
})));
for (let k = 0; k < maps.length; k += 2) {
  // Before and after show the same teeth and phases.
  const [a, b] = [maps[k], maps[k + 1]];
  for (const [one, other] of [[a, b], [b, a]]) {
    const show = one.show.bind(one), point = one.point.bind(one);
    one.show = (view, alone = false) => {
      show(view, true);
      if (!alone) other.show(view, true);
    };
    one.point = (x, y, alone = false) => {
      point(x, y, true);
      if (!alone) other.point(x, y, true);
    };
  }
}

const teeth = ["pitch", "slope"].flatMap((what) => GEARS.map((gear, k) => teethPlot(element(`${what}-${gear}`), {
  title: `${what === "pitch" ? "Pitch" : "Profile slope"} of every tooth of the ${gear} gear with its standard error`,
  yLabel: `${what} / \u00b5m`, paint: `--${gear}`,
  source: { values: DATA.built[k][what], stds: DATA.built[k][`${what}_std`], marked: DATA.built[k].marked },
})));

const plots = { te, residual, spectrum, maps, teeth };
const everyPlot = [te, residual, spectrum, ...maps, ...teeth];

function choose(k) {
  chosen = k;
  const { raw } = recording();
  element("means").textContent =
    `(means taken off: ${signed(raw.curves.mean_before_um, 3)} \u00b5m before, ${signed(raw.curves.mean_after_um, 3)} \u00b5m after; `
    + `grey band: noise, \u00b1 ${signed(raw.noise_um, 3)} \u00b5m)`
    + (raw.curves.per_stretch > 1 ? `; ${raw.curves.samples} samples, drawn from least to greatest of every ${raw.curves.per_stretch}` : "");
  element("map-note").textContent = raw.maps.note;
  for (const one of [te, residual, spectrum]) one.reset();
  for (const one of maps) one.rekey();
}

const list = element("recording");
DATA.recordings.forEach((one, k) => list.add(new Option(one.label, String(k))));
element("choose").hidden = DATA.recordings.length < 2;
list.addEventListener("change", () => choose(Number(list.value)));
element("scale").addEventListener("change", () => maps.forEach((one) => one.rekey()));

// Turn the plots to a tooth's mesh in the middle of the recording, or to an order of a shaft.
function showPlace({ gear, tooth, order }) {
  if (order !== undefined) {
    const x = Number(order) * (Number(gear) === 0 ? 1 : z1 / z2);
    spectrum.reset();
    spectrum.show({ ...spectrum.view, x0: x - 3, x1: x + 3 });
    spectrum.point(x, null);
    element("plot-spectrum").scrollIntoView({ block: "center" });
    return;
  }
  const { places, raw } = recording();
  const pitch = 360 / z2, late = raw.coast ? 0.5 : 0, z = DATA.z[gear];
  // On the coast flank driving tooth n meets driven tooth n + 1, half a pitch later.
  const first = Number(tooth) - (raw.coast && Number(gear) === 1 ? 1 : 0);
  const middle = 0.5 * (places[0] + places[places.length - 1]) / pitch - late;
  const x = (first + z * Math.round((middle - first) / z) + late) * pitch;
  for (const one of [te, residual]) {
    one.reset();
    one.show({ ...one.view, x0: x - 2 * pitch, x1: x + 2 * pitch });
    one.fitHeight();
  }
  te.point(x, null);
  element("plot-te").scrollIntoView({ block: "start" });
}
for (const button of /** @type {NodeListOf<HTMLButtonElement>} */ (document.querySelectorAll("button.show"))) {
  button.hidden = false;
  button.addEventListener("click", () => showPlace(/** @type {any} */ (button.dataset)));
}

function repaint() {
  forgetColours();
  for (const one of everyPlot) one.refresh();
}
themes(repaint);
// Paper is white: plots are drawn in the light look, and in the chosen one again afterwards.
let themeBefore;
window.addEventListener("beforeprint", () => {
  themeBefore = document.documentElement.dataset.theme;
  document.documentElement.dataset.theme = "light";
  forgetColours();
  for (const one of everyPlot) one.draw(); // now: no frame comes before the print
});
window.addEventListener("afterprint", () => {
  if (themeBefore === undefined) delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = themeBefore;
  repaint();
});
choose(0);
for (const one of everyPlot) one.draw(); // now: what prints or pictures a page at once waits for no frame

Object.assign(window, { gearpoly: { data: DATA, plots, recording, choose } });
