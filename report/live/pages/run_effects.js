// The list of effects: switch, amount, gain, inner parameter, and the error that a switch leads to.

import { element, slider, toggle } from "../parts/elements.js";
import { digits, fixed, rms } from "../parts/numbers.js";

const MOST_GAIN = 2;

export class EffectList {
  constructor(place, board, data, changed) {
    Object.assign(this, { place, board, data, changed, rows: new Map() });
  }

  /** Makes the list anew. */
  refresh() {
    const { switches } = this.board, found = switches.filter(s => s.isFound);
    const alike = switches.filter(s => !s.isFound && s.alike.length);
    const others = switches.filter(s => !s.isFound && !s.alike.length);
    this.rows.clear();
    const block = (title, members) => (members.length ? element("section", {},
      element("h3", { text: title }),
      element("ul", {}, ...members.map(one => this.row(one)))) : null);
    const none = switches.length ? null : element("p", { class: "hint",
      text: "The library has no effect that these touches could show." });
    this.place.replaceChildren(...[
      block(this.data.isPrediction ? "In the model" : "Found", found), this.remains(), block("Cannot be distinguished from it", alike),
      block(found.length ? "Other effects" : "Effects that suit the residual best", others), none,
    ].filter(Boolean));
  }

  /** What the report says of the residual, with everything that was found. */
  remains() {
    if (!this.data.remains) return null;
    return element("section", {}, element("h3", { text: "What remains" }),
      element("p", { class: "hint", text: this.data.remains }));
  }

  row(one) {
    const box = toggle({
      label: one.title, value: one.isOn,
      changed: isOn => {
        this.board.toggle(one, isOn);
        this.changed();
      },
    });
    box.box.dataset.effect = one.name;
    const scent = element("small", { class: "scent" });
    const more = element("div", { class: "more" });
    const made = element("li", {}, box, element("code", { text: one.name, title: one.formula }),
      scent, more);
    this.rows.set(one, { box, scent, more, made });
    return made;
  }

  /** Amounts as fitted now, with sliders of what is on. */
  show(now) {
    for (const [one, row] of this.rows) {
      row.box.set(one.isOn);
      row.made.classList.toggle("on", one.isOn);
      if (!one.isOn) {
        row.more.replaceChildren();
        row.sliders = null;
        continue;
      }
      if (!row.sliders) this.opened(one, row);
      row.amount.textContent = this.amount(one, now);
      row.sliders.gain.set(one.gain === null ? 1 : one.gain);
      row.free.disabled = one.gain === null;
      if (row.sliders.inner) row.sliders.inner.set(this.spaced(one, one.value));
    }
  }

  opened(one, row) {
    row.amount = element("p", { class: "amount" });
    const gain = slider({
      label: "gain", low: 0, high: MOST_GAIN, value: 1, step: 0.01,
      words: v => (one.gain === null && !one.isFixed ? "fitted" : `× ${fixed(v, 2)}`),
      input: v => {
        this.board.pull(one, v);
        this.changed();
      },
    });
    row.free = element("button", {
      type: "button", ...(one.isFixed
        ? { text: "as predicted", title: "the amount of the model again" }
        : { text: "fit again", title: "let the run determine the amount again" }),
      onclick: () => {
        this.board.pull(one, null);
        this.changed();
      },
    });
    const inner = one.inner ? this.innerSlider(one) : null;
    row.sliders = { gain, inner };
    row.more.replaceChildren(row.amount, element("div", { class: "gain" }, gain, row.free),
      ...(inner ? [inner] : []));
  }

  spaced(one, v) {
    return one.inner.isRatio ? Math.log(v) : v;
  }

  innerSlider(one) {
    const { values, name, unit, isRatio } = one.inner, every = values.values;
    const back = v => (isRatio ? Math.exp(v) : v);
    const home = every[one.inner.present];
    const near = v => (Math.abs(this.spaced(one, home) - v)
      < 0.004 * (this.spaced(one, every[every.length - 1]) - this.spaced(one, every[0])));
    const made = slider({
      label: name, low: this.spaced(one, every[0]), high: this.spaced(one, every[every.length - 1]),
      value: this.spaced(one, one.value), words: v => `${digits(near(v) ? home : back(v))} ${unit}`,
      input: v => {
        one.value = near(v) ? home : back(v);  // the present value is met exactly
        if (one.gain !== null) this.board.pull(one, null);
        this.changed();
      },
    });
    made.range.dataset.inner = one.name;
    return made;
  }

  /** `amplitude 8.59 ± 0.26 µm`, or of many parameters what they explain. */
  amount(one, now) {
    const { board, data } = this, explained = rms(board.contribution(one, now));
    const share = `moves the residuals by ${digits(explained, 2)} ${data.unit} rms`;
    if (one.isFixed) {
      const gain = one.gain === null ? "" : `× ${fixed(one.gain, 2)} of `;
      return capital(`${gain}what the model predicts; ${share}`);
    }
    if (one.size && now.isAsFound) return capital(`${one.size.replace(/-(?=\d)/g, "−")}; ${share}`);
    if (one.amounts.length > 2) return capital(share);
    const amounts = board.amounts(one, now), place = now.own.find(([other]) => other === one)?.[1];
    const parts = one.amounts.map(({ name, unit, sd }, k) => {
      const value = amounts[k] * sd;
      if (one.gain !== null) return `${name} ${digits(value)} ${unit} (set)`;
      const u = now.spread[place + k] * sd;
      const places = Math.max(0, 1 - Math.floor(Math.log10(u || 1)));
      return `${name} ${fixed(value, places)} ± ${fixed(u, places)} ${unit}`;
    });
    return capital(`${parts.join(", ")}; ${share}`);
  }

  /** Beside every switch the error of held-out touches that it leads to, one after the other. */
  scents() {
    const turn = this.turn = {}, rows = [...this.rows];
    const next = () => {
      if (turn !== this.turn) return;  // another switch came between
      const begun = performance.now();
      while (rows.length && performance.now() - begun < 12) this.scent(...rows.shift());
      if (rows.length) setTimeout(next);
      else this.place.dataset.scents = "true";
    };
    next();
  }

  scent(one, row) {
    const heldOut = this.board.scent(one);
    const others = this.board.on.filter(other => this.board.areAlike(one, other));
    const way = one.isOn ? "without it" : others.length ? "in its place" : "with it";
    row.scent.textContent = `${way} ${fixed(heldOut, 3)} `
      + this.data.unit;
    row.scent.title = "held-out error after this switch";
  }
}

function capital(words) {
  return words[0].toUpperCase() + words.slice(1);
}
