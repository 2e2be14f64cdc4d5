// The errors of a machine, each with a switch and a factor; several by name, axis or class.

import { element, slider, toggle } from "./elements.js";
import { digits } from "./numbers.js";

const MOST = 3;  // largest factor

/** errors: those of the page; weights: one factor each; changed(): after every change. */
export class ErrorList {
  constructor(place, errors, weights, changed) {
    Object.assign(this, { errors, weights, changed });
    this.rows = errors.map((error, k) => this.row(error, k));
    const words = [...new Set(errors.flatMap(e => e.words))];
    this.kind = element("select", { "aria-label": "which errors", onchange: () => this.filter() },
      element("option", { text: "all errors", value: "" }),
      ...words.map(w => element("option", { text: w, value: w })));
    this.find = element("input", { type: "search", placeholder: "name", "aria-label": "find an error",
      oninput: () => this.filter() });
    this.whole = slider({ label: "scale these", low: 0, high: MOST,
      value: weights.every(w => w === 0) ? 0 : 1, step: 0.01,
      words: v => `× ${v.toFixed(2)}`, input: v => this.scale(v) });
    const set = (text, weight) => element("button", { type: "button", text,
      onclick: () => this.scale(weight) });
    this.list = element("ul", { class: "errors" }, ...this.rows.map(r => r.item));
    place.append(
      element("div", { class: "row" }, this.kind, this.find),
      element("div", { class: "row" }, set("on", 1), set("off", 0)), this.whole, this.list);
    this.update();
  }

  row(error, k) {
    const reading = element("output", { "aria-hidden": "true" }), bar = element("i");
    const box = toggle({ label: error.name, value: this.weights[k] !== 0,
      changed: v => { this.weights[k] = v ? 1 : 0; this.update(); this.changed(); } });
    box.title = `${error.title}; ${digits(error.size)} ± ${digits(error.u, 2)} µm rms over the `
      + "workspace";
    const factor = slider({ label: "factor", low: -MOST, high: MOST, value: this.weights[k],
      step: 0.01, words: v => `× ${v.toFixed(2)}`,
      input: v => { this.weights[k] = v; this.update(k); this.changed(); } });
    factor.range.setAttribute("aria-label", `factor of ${error.name}`);
    const more = element("details", {}, element("summary", { text: error.title }), factor);
    const item = element("li", {}, element("div", { class: "head" }, box, reading),
      element("div", { class: "bar" }, bar), more);
    return { item, box, factor, reading, bar };
  }

  /** Numbers of the errors that are listed. */
  listed() {
    const word = this.kind.value, text = this.find.value.trim().toLowerCase();
    return this.errors.map((e, k) => [e, k]).filter(([e]) => (!word || e.words.includes(word))
      && (!text || `${e.name} ${e.title}`.toLowerCase().includes(text))).map(([, k]) => k);
  }

  filter() {
    const shown = new Set(this.listed());
    this.rows.forEach((r, k) => { r.item.hidden = !shown.has(k); });
  }

  scale(weight) {
    for (const k of this.listed()) this.weights[k] = weight;
    this.whole.set(weight);
    this.update();
    this.changed();
  }

  /** Shows the factors, but not that of the slider that is held. */
  update(held = -1) {
    this.rows.forEach((r, k) => {
      r.box.set(this.weights[k] !== 0);
      if (k !== held) r.factor.set(this.weights[k]);
    });
  }

  /** Shows what every error adds at the pose, lengths in µm. */
  contributions(sizes) {
    const most = Math.max(...sizes, 1e-9);
    this.rows.forEach((r, k) => {
      // what rounding leaves of nothing is nothing: a picometre
      r.reading.textContent = `${digits(sizes[k] < 1e-6 ? 0 : sizes[k])} µm`;
      r.bar.style.width = `${100 * sizes[k] / most}%`;
    });
  }
}
