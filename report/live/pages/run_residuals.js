// Residuals over a recorded column, held-out error by pose, and the chosen touches as a table.

import { Bars } from "../parts/bars.js";
import { copied, element, table } from "../parts/elements.js";
import { digits, fixed, quantile } from "../parts/numbers.js";
import { Scatter } from "../parts/scatter.js";
import { programmed } from "./run_touched.js";

const MOST_ROWS = 200;  // of the table that are shown; all are copied

export class Residuals {
  constructor(page, board, { mark, choose }) {
    const { data } = board;
    Object.assign(this, { data, board, choose, onMark: mark, chosenPlace: page.querySelector("#chosen") });
    this.overPlace(page.querySelector(".residuals"));
    this.plot = new Scatter(this.canvas, { over: mark, brushed: choose });
    this.title = page.querySelector("#by-pose-title");
    this.bars = new Bars(page.querySelector("#by-pose"), { bottom: 30,
      over: k => this.overBar(k), pressed: k => choose(this.members(k)) });
    this.top = 0;
    this.pick(data.curves.length ? data.columns.length : 0);
  }

  overPlace(place) {
    const names = this.data.columns.map((c, k) => element("option", { value: k,
      text: `residual over ${lowered(c.name)}` }));
    const laws = this.data.curves.map((c, k) => element("option", { value: names.length + k,
      text: c.title }));
    this.select = element("select", { "aria-label": "what is plotted",
      onchange: () => { this.pick(Number(this.select.value)); this.show(this.shown); } },
    ...names, ...(laws.length ? [element("optgroup", { label: "laws" }, ...laws)] : []));
    this.canvas = element("canvas", { role: "img",
      "aria-label": "Residual of every touch over a recorded column" });
    place.append(element("div", { class: "below" },
      element("label", {}, "Plot ", this.select),
      this.hint = element("span", { class: "hint" })), this.canvas);
  }

  pick(k) {
    const { columns, curves, unit } = this.data, count = columns.length;
    this.select.value = k;
    this.law = k < count ? null : curves[k - count];
    this.column = this.law ? { values: this.law.touchX.values, name: this.law.label } : columns[k];
    this.plot.frame.yLabel = this.law ? this.law.carrier : `residual in ${unit}`;
    this.lawEnds = this.law && this.endsOf(this.law);
    const finite = this.column.values.filter(Number.isFinite);
    const [low, high] = finite.length ? extent(finite) : [0, 1];
    this.xRange = [low, high];
    this.ends = null;
    this.plot.frame.xLabel = this.column.name;
  }

  show(shown) {
    this.shown = shown;
    const { residual, colours, chosen, limit } = shown;
    this.top = Math.max(this.top, 1.8 * limit);  // fixed, else nothing is seen to fall
    this.plot.chosen = chosen;
    const [seen, curve] = this.law ? this.putBack(this.law, shown) : [residual, null];
    const [least, most] = this.lawEnds || [-this.top, this.top];  // gross errors stand at the edge
    const y = seen.map(v => Math.max(least, Math.min(most, v)));
    const [low, high] = extent([...y, ...(this.ends || [-2 * this.data.noise, 2 * this.data.noise])]);
    this.ends = [low, high];  // they only grow
    this.plot.show({ x: this.column.values, y, colours, xRange: this.xRange,
      yRange: [low - 0.04 * (high - low), high + 0.04 * (high - low)], band: this.law ? 0 : 2 * this.data.noise, curve });
    const alone = this.data.touches.isSpread ? "" : "all readings at one place: no picture in space; ";
    this.hint.textContent = `${alone}drag to choose touches, click to choose none; ${this.law
      ? `${curve ? "line: the law with ± 2 u; " : ""}dots: residuals${
        curve ? " with the law put back" : ""}, over their levers on ${this.law.carrier}`
      : "shaded: ± 2 u of the stated noise"}; gross errors stand at the edge`;
    this.byPose(shown);
    this.list(shown);
  }

  /** What every touch shows of a law, and its curve as it is on now; flat where it is off. */
  putBack({ law, x, value, u, touchValue, lever }, { residual, now }) {
    const one = this.board.switches.find(s => s.name === law);
    const share = this.board.isMoved(one) ? 0 : this.board.share(one, now);
    const seen = residual.map((r, i) => r / lever.values[i] + share * touchValue.values[i]);
    if (!share) return [seen, null];  // what remains shows the law
    return [seen, { x: x.values, y: value.values.map(v => share * v),
      half: u.values.map(v => 2 * v) }];
  }

  /** Ends of the scale of a law: those of its curve as it was learnt, and of nearly all touches. */
  endsOf({ value, lever, touchValue }) {
    const rest = this.board.residuals(this.board.errors());
    const seen = rest.map((r, i) => r / lever.values[i] + touchValue.values[i]);
    const ends = [0, quantile(seen, 0.02), quantile(seen, 0.98), ...value.values];
    const [low, high] = extent(ends.filter(Number.isFinite)), room = 0.15 * (high - low) || 1;
    return [low - room, high + room];
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
      : `Held-out error by ${this.data.touches.setups.length > 1 ? "set-up and " : ""}${this.data.touches.poseWord}`;
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
    const { unit, columns, touches: { programs } } = this.data;
    return ["line", ...(programs.length ? ["program"] : []), "feature", "set-up", "pose", `residual in ${unit}`, `u in ${unit}`,
      `measured in ${unit}`, ...columns.map(c => c.name)];
  }

  rows(rows, residual, now) {
    const { touches: t, columns } = this.data;
    return rows.map(i => [String(t.line.values[i]),
      ...(t.programs.length ? [programmed(t, i)] : []), t.features[t.feature.values[i]],
      t.setups[t.setup.values[i]], String(t.pose.values[i]), fixed(residual[i], 3),
      fixed(t.u.values[i] * now.s, 3), fixed(t.measured.values[i], 3),
      ...columns.map(c => digits(c.values[i], 6))]);
  }
}

/** A name within a sentence: names of axes and symbols stay. */
function lowered(name) {
  return /^[A-Z][a-z]/.test(name) ? name[0].toLowerCase() + name.slice(1) : name;
}

function extent(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const v of values) {
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return [low, high];
}
