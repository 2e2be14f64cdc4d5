// Sensitivity of the tool point to every error parameter at a pose: S_E(q), a table with bars.

import { element } from "./elements.js";
import { deviationOf, noErrors } from "./kinematics.js";
import { digits, signed } from "./numbers.js";

const STEP = 1e-3;  // µm or µrad in mm or rad: so small that the second order is not seen

/** symbols: [{ name, title, part, link, component }]; axes: their names. */
export class SensitivityList {
  constructor(place, machine, symbols, axes) {
    Object.assign(this, { machine, symbols });
    this.kind = element("select", { "aria-label": "errors of", onchange: () => this.filter() },
      element("option", { text: "all", value: "" }), ...[...axes, "w", "t"].map(
        a => element("option", { text: a === "w" ? "workpiece" : a === "t" ? "tool" : a,
          value: a })));
    this.rows = symbols.map(symbol => {
      const bar = element("i"), reading = element("output");
      const item = element("li", { title: symbol.title }, element("span", { text: symbol.name }),
        element("div", { class: "bar" }, bar), reading);
      return { item, bar, reading, symbol };
    });
    this.whole = place;
    place.append(element("div", { class: "row" }, this.kind),
      element("ul", { class: "bars" }, ...this.rows.map(r => r.item)));
    place.addEventListener("toggle", () => this.again());
  }

  filter() {
    for (const { item, symbol } of this.rows) {
      item.hidden = Boolean(this.kind.value) && symbol.axis !== this.kind.value;
    }
  }

  again() {
    if (this.pose) this.show(...this.pose);
  }

  /** Displacement of the tool point per unit of one parameter, table frame, mm per mm or rad. */
  column(symbol, q, length) {
    const errors = noErrors(this.machine), at = 6 * symbol.link + symbol.component;
    errors[symbol.part][at] = STEP;
    const there = deviationOf(this.machine, q, length, errors);
    errors[symbol.part][at] = -STEP;
    const back = deviationOf(this.machine, q, length, errors);
    return there.map((v, k) => (v - back[k]) / (2 * STEP));
  }

  show(q, length) {
    this.pose = [q, length];
    if (!this.whole.open) return;
    const all = this.rows.map(({ symbol }) => {
      // µm per µrad is mm per rad over a thousand
      const unit = symbol.component < 3 ? 1 : 1e-3;
      return this.column(symbol, q, length).map(v => unit * v);
    });
    const sizes = all.map(v => Math.hypot(...v)), most = Math.max(...sizes, 1e-9);
    this.rows.forEach((r, k) => {
      const unit = r.symbol.component < 3 ? "µm/µm" : "µm/µrad";
      r.bar.style.width = `${100 * sizes[k] / most}%`;
      r.reading.textContent = `${digits(sizes[k])} ${unit}`;
      r.reading.title = `x ${signed(all[k][0])}, y ${signed(all[k][1])}, z ${signed(all[k][2])}`;
    });
  }
}
