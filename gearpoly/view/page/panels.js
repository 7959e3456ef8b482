// Words and numbers beside the picture.

import { DEG, modulo, signed, UM } from "../../page/kit/data.js";
import { element } from "../../page/kit/dom.js";

function make(tag, text, attributes = {}) {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

function degrees(rad, digits) {
  return `${signed(rad / DEG, digits)}\u00b0`;
}

export class Panels {
  constructor(pair, recording, act) {
    this.pair = pair;
    this.recording = recording;
    this.act = act; // what a click does: follow(contact), jump(theta_2), select(gear, tooth)
    this.rows = [];
    const { data } = pair;
    element("name").textContent = data.name;
    const [driving, driven] = pair.gears;
    const load = data.torque_nm > 0
      ? `${Number(data.torque_nm.toPrecision(4))} N\u00b7m${pair.loaded ? "" : " (rigid teeth)"}` : "no load";
    element("condition").textContent =
      `${driving.z} on ${driven.z} teeth, ${data.flank} flank, ${load}, driving ${driving.origin}, driven ${driven.origin}`
      + (driving.origin === "drawn" || driven.origin === "drawn" ? ` (seed ${data.seed})` : "");
    const list = element("remarks");
    for (const remark of data.remarks) list.append(make("li", remark));
    list.hidden = data.remarks.length === 0;
    element("force-head").textContent = pair.loaded ? "force N" : "";
    element("miss-line").hidden = !recording;
    element("load-line").hidden = !pair.loaded;
    if (recording) this.places();
  }

  now(state) {
    const put = (id, text) => {
      const node = element(id);
      if (node.textContent !== text) node.textContent = text;
    };
    put("theta-2", degrees(state.theta_2, 5));
    put("theta-1", degrees(state.theta_1, 5));
    put("te", `${signed(state.te_um, 4)} \u00b5m`);
    const arcsec = (state.te_um * UM) / this.pair.gears[1].r_b / DEG * 3600;
    put("te-angle", `${signed(arcsec, 3)}\u2033`);
    put("backlash", state.backlash_um === null ? "none" : `${signed(state.backlash_um, 3)} \u00b5m`);
    put("pairs", String(state.pairs));
    if (this.pair.loaded) {
      put("approach", `${signed(state.approach_um, 3)} \u00b5m`);
      put("stiffness", state.stiffness === null ? "\u2013" : `${state.stiffness.toFixed(0)} N/\u00b5m`);
    }
    if (this.recording) {
      const { miss, count } = state;
      put("miss", count > 0 ? `${signed(miss, 3)} \u00b5m` : "not recorded here");
      put("miss-count", count > 0 ? `mean of ${count}` : "");
    }
  }

  // One row per near pair, first touch first; rows are kept and refilled, since they change sixty times a second.
  contacts(state, followed) {
    const body = element("contacts");
    while (this.rows.length < state.contacts.length) {
      const row = make("tr");
      const button = make("button", "", { type: "button", class: "pair" });
      const head = make("th", undefined, { scope: "row" });
      head.append(button);
      row.append(head);
      for (let k = 0; k < 4; k++) row.append(make("td"));
      const place = this.rows.length;
      button.addEventListener("click", () => this.act.follow(this.shown[place]));
      body.append(row);
      this.rows.push({ row, button, cells: [...row.querySelectorAll("td")] });
    }
    this.shown = state.contacts;
    this.rows.forEach(({ row, button, cells }, k) => {
      const one = state.contacts[k];
      row.hidden = !one;
      if (!one) return;
      const put = (node, text) => {
        if (node.textContent !== text) node.textContent = text;
      };
      put(button, `${one.driving} on ${one.driven}`);
      button.setAttribute("aria-pressed", String(one === followed));
      button.setAttribute("aria-label", `Follow driving tooth ${one.driving} on driven tooth ${one.driven}`);
      put(cells[0], one.gap_um < 5e-7 ? "0" : one.gap_um < 10 ? one.gap_um.toFixed(4) : one.gap_um.toFixed(2));
      // A tip corner that touches stands on the edge of its flank.
      [0, 1].forEach((which) => {
        put(cells[1 + which], one.radius[which].toFixed(3));
        cells[1 + which].classList.toggle("tip", one.feature.startsWith(which === 0 ? "driving" : "driven"));
        cells[1 + which].title = one.feature === "flank" ? "" : `the ${one.feature} touches`;
      });
      const force = one.force > 0 ? `${one.force.toFixed(0)} (${(100 * one.share).toFixed(0)} %)` : "";
      put(cells[3], force || (one.touching ? "touches" : "apart"));
      row.classList.toggle("touching", one.touching);
    });
  }

  // The card of a clicked tooth: where both flanks stand, and every mesh of the cycle in which it takes part.
  tooth(gear, tooth) {
    const { pair } = this;
    element("tooth-card").hidden = false;
    element("tooth-none").hidden = true;
    element("tooth-name").textContent = `${gear.name === "driving" ? "Driving" : "Driven"} tooth ${tooth}`;
    const pitch = gear.radius.findIndex((r) => r >= gear.r);
    const at = (side) => signed(gear.deviation(side, tooth, pitch), 2);
    const before = modulo(tooth - 1, gear.z);
    const step = gear.deviation("drive", tooth, pitch) - gear.deviation("drive", before, pitch);
    element("tooth-words").textContent =
      `At the reference circle: drive flank ${at("drive")} \u00b5m, coast flank ${at("coast")} \u00b5m; `
      + `single pitch from tooth ${before}: ${signed(step, 2)} \u00b5m (normal, + = more material).`
      + (gear.chipped.has(tooth) ? ` It ends ${(gear.r_a - gear.tipOf(tooth)).toFixed(3)} mm below the tip circle.` : "");
    const list = element("tooth-meshes");
    list.replaceChildren();
    for (let mesh = 0; mesh < pair.data.meshes; mesh++) {
      const teeth = pair.teeth(mesh, pair.data.flank);
      const mine = gear.name === "driving" ? teeth[0] : teeth[1];
      if (mine !== tooth) continue;
      const theta_2 = pair.angleOf(mesh);
      const mate = gear.name === "driving" ? teeth[1] : teeth[0];
      const mismatch = this.recording ? this.recording.over(theta_2 - 0.5 * pair.tau, theta_2 + 0.5 * pair.tau) : null;
      const button = make("button", `${degrees(theta_2, 1)}`, { type: "button" });
      button.setAttribute("aria-label", `Jump to ${degrees(theta_2, 1)}: with tooth ${mate}`);
      button.append(make("small", mismatch && mismatch.count > 0 ? `with ${mate}, ${signed(mismatch.mean, 2)} \u00b5m` : `with ${mate}`));
      button.addEventListener("click", () => this.act.jump(theta_2));
      const item = make("li");
      item.append(button);
      list.append(item);
      if (list.children.length >= 400) break; // a longer list helps nobody
    }
  }

  // Where compare finds that recording and simulation differ; teeth are one click away.
  places() {
    const { recording } = this;
    element("recording").hidden = false;
    element("recording-words").textContent =
      `${recording.file}: ${recording.samples.toLocaleString("en")} samples, ${recording.cycles.toFixed(2)} hunting cycles; `
      + `${recording.rms_um.toFixed(3)} \u00b5m rms left about ${signed(recording.mean_um, 3)} \u00b5m, noise ${recording.noise_um.toFixed(3)} \u00b5m`
      + (recording.every > 1 ? `; one sample of ${recording.every} is shown` : "")
      + (recording.open.length ? `; tooth numbers of the ${recording.open.join(" and ")} gear are the picture's own, the recording does not tell them.` : ".");
    const list = element("where");
    recording.where.forEach((entry) => {
      const item = make("li");
      const says = entry.says.charAt(0).toUpperCase() + entry.says.slice(1);
      if (entry.tooth === null && entry.kind !== "mesh_phase") {
        item.append(make("span", says));
      } else {
        const button = make("button", says, { type: "button", class: "place" });
        button.addEventListener("click", () => this.act.place(entry));
        item.append(button);
      }
      list.append(item);
    });
    if (recording.where.length === 0) list.append(make("li", "Nothing beyond noise."));
  }
}
