// Residuals over a recorded column, held-out error by pose, and the chosen touches as a table.

import { Bars } from "../parts/bars.js";
import { copied, element, table } from "../parts/elements.js";
import { digits, fixed } from "../parts/numbers.js";
import { Scatter } from "../parts/scatter.js";

const MOST_ROWS = 200;  // of the table that are shown; all are copied

export class Residuals {
  constructor(page, data, { mark, choose }) {
    Object.assign(this, { data, choose, onMark: mark, chosenPlace: page.querySelector("#chosen") });
    this.overPlace(page.querySelector(".residuals"));
    this.plot = new Scatter(this.canvas, { over: mark, brushed: choose });
    this.plot.frame.yLabel = `residual in ${data.unit}`;
    this.title = page.querySelector("#by-pose-title");
    this.bars = new Bars(page.querySelector("#by-pose"), { bottom: 30,
      over: k => this.overBar(k), pressed: k => choose(this.members(k)) });
    this.top = 0;
    this.pick(0);
  }

  overPlace(place) {
    const names = this.data.columns.map((c, k) => element("option", { value: k, text: c.name }));
    this.select = element("select", { "aria-label": "column to plot residuals over",
      onchange: () => { this.pick(Number(this.select.value)); this.show(this.shown); } }, ...names);
    this.canvas = element("canvas", { role: "img",
      "aria-label": "Residual of every touch over a recorded column" });
    place.append(element("div", { class: "below" },
      element("label", {}, "Residual over ", this.select),
      element("span", { class: "hint", text: "drag to choose touches, click to choose none; "
        + "shaded: ± 2 u of the stated noise; gross errors stand at the edge" })), this.canvas);
  }

  pick(k) {
    this.column = this.data.columns[k];
    const finite = this.column.values.filter(Number.isFinite);
    const [low, high] = finite.length ? extent(finite) : [0, 1];
    this.xRange = [low, high];
    this.plot.frame.xLabel = this.column.name;
  }

  show(shown) {
    this.shown = shown;
    const { residual, colours, chosen, limit } = shown;
    this.top = Math.max(this.top, 1.8 * limit);  // fixed, else nothing is seen to fall
    this.plot.chosen = chosen;
    const edge = this.top;  // gross errors stand at the edge
    const y = residual.map(v => Math.max(-edge, Math.min(edge, v)));
    this.plot.show({ x: this.column.values, y, colours, xRange: this.xRange,
      yRange: [-this.top, this.top], band: 2 * this.data.noise });
    this.byPose(shown);
    this.list(shown);
  }

  mark({ marked }) {
    this.plot.marked = marked;
    this.plot.draw();
    const k = marked < 0 ? -1 : this.data.touches.group.values[marked];
    this.bars.show({ marked: k === 65535 ? -1 : k });
  }

  byPose({ now, residual }) {
    const { groups: names, group, state } = this.data.touches;
    let values = now.groups;
    if (!values.length) values = this.ofTestRows(names.length, group.values, residual, state.values);
    this.title.textContent = names.length && /^lines/.test(names[0])
      ? "Held-out error by stretch of the run"
      : `Held-out error by ${this.data.touches.setups.length > 1 ? "set-up and " : ""}table pose`;
    if (!this.before) {
      this.before = values;
      this.barTop = Math.max(...values.filter(Number.isFinite), this.data.noise);
      this.bars.frame.yLabel = `held out, ${this.data.unit}`;
    }
    this.barTop = Math.max(this.barTop, ...values.filter(Number.isFinite));
    this.bars.show({ values, names, line: this.data.noise, top: this.barTop });
  }

  /** Root mean square by pose, of the rows that the file marks as held out. */
  ofTestRows(count, group, residual, state) {
    const squares = new Float64Array(count), touches = new Float64Array(count);
    for (let i = 0; i < residual.length; i++) {
      if (group[i] === 65535 || state[i] !== 2) continue;
      squares[group[i]] += residual[i] ** 2;
      touches[group[i]]++;
    }
    return [...squares].map((q, k) => Math.sqrt(q / touches[k]));
  }

  members(k) {
    const { group, count } = this.data.touches;
    return Array.from({ length: count }, (_, i) => i).filter(i => group.values[i] === k);
  }

  overBar(k) {
    if (this.bars.marked !== k) this.bars.show({ marked: k });
  }

  /** Chosen touches as a table, to copy. */
  list({ chosen, residual, now }) {
    if (!chosen) {
      this.chosenPlace.replaceChildren();
      return;
    }
    const rows = [...chosen].sort((a, b) => a - b), text = this.rows(rows, residual, now);
    const heads = this.heads();
    const square = rows.reduce((sum, i) => sum + residual[i] ** 2, 0) / rows.length;
    const copy = element("button", { type: "button", text: "copy",
      onclick: async () => {
        await copied([heads, ...text].map(row => row.join("\t").replaceAll("−", "-")).join("\n"));
        copy.textContent = "copied";
      } });
    this.chosenPlace.replaceChildren(
      element("h3", {}, `${rows.length} touches chosen, ${digits(Math.sqrt(square))} `
        + `${this.data.unit} rms `, copy),
      element("div", { class: "rows", tabindex: "0" },
        table(heads, text.slice(0, MOST_ROWS),
          text.length > MOST_ROWS ? `the first ${MOST_ROWS}; all are copied` : "")));
  }

  heads() {
    const { unit, columns } = this.data;
    return ["line", "feature", "set-up", "pose", `residual in ${unit}`, `u in ${unit}`,
      `measured in ${unit}`, ...columns.map(c => c.name)];
  }

  rows(rows, residual, now) {
    const { touches: t, columns } = this.data;
    return rows.map(i => [String(t.line.values[i]), t.features[t.feature.values[i]],
      t.setups[t.setup.values[i]], String(t.pose.values[i]), fixed(residual[i], 3),
      fixed(t.u.values[i] * now.s, 3), fixed(t.measured.values[i], 3),
      ...columns.map(c => digits(c.values[i], 6))]);
  }
}

function extent(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const v of values) {
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return [low, high];
}
