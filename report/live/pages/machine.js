// The machine that moves: readings, errors, tool point, a program that is played.

import { axisOrder } from "../parts/axis_order.js";
import { pageData } from "../parts/data.js";
import { Curves } from "../parts/curve.js";
import { element, slider, toggle } from "../parts/elements.js";
import { ErrorList } from "../parts/error_list.js";
import { ErrorSum } from "../parts/error_sum.js";
import { bodyPoses, deviationOf, noErrors, toolPoint } from "../parts/kinematics.js";
import { MachineView } from "../parts/machine_view.js";
import { digits, fixed } from "../parts/numbers.js";
import { Player } from "../parts/player.js";
import { ProgramPanel } from "../parts/program_panel.js";
import { SensitivityList } from "../parts/sensitivity_list.js";
import { colour, themeButton } from "../parts/theme.js";

const DEG = Math.PI / 180, UM = 1000;
const ROWS = 3000;  // positions of a program at which its path is worked out
const AROUND = 15;  // s before and behind that are drawn of a path that is not drawn whole

const data = await pageData(), byId = id => document.getElementById(id);
const { machine, axes } = data;

const sum = new ErrorSum(machine, data.errors, data.low, data.high);
sum.weights.fill(data.is_assumed ? 0 : 1);
const player = data.program ? new Player(data.program, axes.length) : null;
const view = new MachineView(byId("scene"), byId("letters"), data);
const state = {
  q: Float64Array.from(axes, a => Math.min(Math.max(0, a.low), a.high)),
  sides: new Int8Array(axes.length), time: 0, length: data.length, row: -1,
  exaggeration: data.exaggeration, isActual: false,
  isWhole: Boolean(data.program && !data.program.touch),
  datum: data.datum, isFromDatum: Boolean(player && data.datum),
};

/** Errors at a pose; one alone, or all by their factors. */
function errorsAt(pose, which = -1) {
  return sum.add([...pose.q, pose.time], pose.sides, noErrors(machine), which);
}

/** Deviation of the tool point, table frame, mm; less that at the preset where that is asked for. */
function deviationAt(pose, which = -1) {
  const here = deviationOf(machine, pose.q, pose.length ?? state.length, errorsAt(pose, which));
  if (!state.isFromDatum) return here;
  const there = atDatum(which);
  return here.map((v, k) => v - there[k]);
}

const kept = new Map();  // deviations at the preset, until a factor changes
function atDatum(which) {
  if (!kept.has(which)) {
    const { q, length } = state.datum, sides = new Int8Array(axes.length);
    kept.set(which, deviationOf(machine, q, length, errorsAt({ q, sides, time: 0 }, which)));
  }
  return kept.get(which);
}

const size = v => Math.hypot(...v);

// ---- controls of the axes

const sliders = axes.map((axis, k) => {
  const unit = axis.is_rotary ? DEG : 1, name = axis.is_rotary ? "°" : "mm";
  const made = slider({ label: axis.name, low: axis.low / unit, high: axis.high / unit,
    value: state.q[k] / unit, step: 0.01,
    words: v => `${fixed(v, 3)} ${name}`,
    input: v => {
      if (panel) panel.stop();
      const before = state.q[k];
      state.q[k] = v * unit;
      if (state.q[k] !== before) state.sides[k] = Math.sign(state.q[k] - before);
      state.row = -1;
      show();
    } });
  made.range.id = `axis-${axis.name}`;
  made.unit = unit;
  return made;
});
byId("axes").append(...axisOrder(axes).map(k => sliders[k]));
byId("home").addEventListener("click", () => {
  axes.forEach((a, k) => { state.q[k] = Math.min(Math.max(0, a.low), a.high); });
  state.sides.fill(0);
  state.time = 0;
  state.row = -1;
  if (panel) panel.stop();
  show();
});

byId("view").append(
  slider({ label: "exaggeration", low: 0, high: 4.5, value: Math.log10(state.exaggeration),
    words: v => `× ${digits(10 ** v, 2)}`,
    input: v => { state.exaggeration = 10 ** v; changed(); } }),
  toggle({ label: "bodies with their errors", changed: v => { state.isActual = v; show(); } }),
  toggle({ label: "without bed and column", changed: v => view.hideFoundation(v) }),
  ...(player ? [toggle({ label: "whole path", value: state.isWhole,
    changed: v => { state.isWhole = v; showPath(); } })] : []),
  ...(data.datum ? [toggle({ label: "relative to the preset", value: state.isFromDatum,
    changed: v => { state.isFromDatum = v; changed(); } })] : []));

const errors = data.errors.length
  ? new ErrorList(byId("errors"), data.errors, sum.weights, () => changed()) : null;
const sensitivities = new SensitivityList(byId("sensitivities"), machine, data.symbols,
  axes.map(a => a.name));
const panel = player ? new ProgramPanel(byId("program"), player, data.program, axes, moveTo) : null;
byId("program").hidden = !player;

// ---- the deviation over the program

const curve = player ? new Curves(byId("curve"), { picked: t => panel.go(t * 60) }) : null;
const rows = player ? player.some(ROWS) : [];
const poses = rows.map(row => ({
  q: data.program.q.values.slice(row * axes.length, (row + 1) * axes.length),
  sides: data.program.sides.values.slice(row * axes.length, (row + 1) * axes.length),
  time: player.times[row], length: data.program.length.values[row],
}));
const nominal = new Float32Array(poses.flatMap(p => toolPoint(machine, p.q, p.length)));

const paths = { actual: new Float32Array(0) };

/** The whole path, or what lies about the time: probing goes many times over the same place. */
function drawPath() {
  const seen = rows.map((row, i) => i).filter(i => state.isWhole
    || Math.abs(poses[i].time - state.time) < AROUND);
  const [from, to] = [3 * seen[0], 3 * (seen[seen.length - 1] + 1)];
  view.showPaths(nominal.slice(from, to), paths.actual.slice(from, to));
}

function showPath() {
  if (!player) return;
  const actual = new Float32Array(nominal.length), sizes = new Float64Array(poses.length);
  poses.forEach((pose, i) => {
    const d = deviationAt(pose);
    sizes[i] = UM * size(d);
    for (let k = 0; k < 3; k++) {
      actual[3 * i + k] = nominal[3 * i + k] + state.exaggeration * d[k];
    }
  });
  paths.actual = actual;
  drawPath();
  curve.frame.xLabel = "time, min";
  curve.frame.yLabel = "deviation, µm";
  const times = poses.map(p => p.time / 60), most = Math.max(...sizes, 1e-3);
  curve.show({ curves: [{ x: times, y: sizes, colour: colour("bad"), width: 1 }],
    xRange: [0, player.last / 60], yRange: [0, most] });
  let squares = 0;
  for (const s of sizes) squares += s * s;
  byId("along").textContent = `Deviation along the program: ${digits(Math.sqrt(squares
    / sizes.length))} µm rms, ${digits(Math.max(...sizes))} µm at most`;
}

// ---- what is shown of a pose

function moveTo(time) {
  const pose = player.at(time);
  Object.assign(state, pose, { length: data.program.length.values[pose.row] });
  show();
}

function show() {
  const errorsHere = errorsAt(state), at = toolPoint(machine, state.q, state.length);
  const d = deviationAt(state);
  sliders.forEach((s, k) => s.set(state.q[k] / s.unit));
  let drawn = null;
  if (state.isActual) {
    drawn = errorsHere;
    for (const part of ["twist", "place"]) {
      drawn[part].forEach((v, k) => { drawn[part][k] = v * state.exaggeration; });
    }
  }
  const off = at.map((v, k) => v + state.exaggeration * d[k]);
  const isTouching = Boolean(data.program && data.program.touch && state.row >= 0
    && data.program.touch.values[state.row]);
  view.show({ q: state.q, nominal: at, actual: off, errors: drawn, isTouching });
  for (const [k, letter] of ["x", "y", "z"].entries()) {
    byId(`nominal-${letter}`).textContent = fixed(at[k], 4);
    byId(`actual-${letter}`).textContent = fixed(at[k] + d[k], 4);
    byId(`deviation-${letter}`).textContent = fixed(UM * d[k], 2);
  }
  byId("size").textContent = fixed(UM * size(d), 2);
  const each = data.errors.map((_, k) => {
    const w = sum.weights[k];
    return w ? Math.abs(w) * UM * size(deviationAt(state, k)) : 0;
  });
  if (errors) errors.contributions(each);
  showLargest(each);
  sensitivities.show(state.q, state.length);
  if (panel) panel.update(state, deviationAt(state));
  if (player && !state.isWhole) drawPath();
  if (curve) curve.show({ at: state.row >= 0 ? state.time / 60 : null });
}

function showLargest(each) {
  const order = each.map((v, k) => [v, k]).filter(([v]) => v > 0).sort((a, b) => b[0] - a[0]);
  const most = order.length ? order[0][0] : 1;
  byId("largest").replaceChildren(...order.slice(0, 8).map(([v, k]) => element("li", {
    title: data.errors[k].title }, element("span", { text: data.errors[k].name }),
  element("div", { class: "bar" }, element("i", { style: `width:${100 * v / most}%` })),
  element("output", { text: `${digits(v)} µm` }))));
  byId("none").hidden = order.length > 0;
}

function changed() {
  kept.clear();
  showPath();
  show();
}

themeButton(byId("theme"), () => {
  view.recolour();
  changed();
});
if (player) moveTo(0); else show();
view.look(nominal);
const asked = Number(new URLSearchParams(location.search).get("t") || location.hash.slice(1));
if (player && asked) panel.go(asked);

// for tests, and for readers of the page's source
window.machinePage = { data, machine, state, sum, view, show, changed, panel,
  toolPoint: (q, length, found = null) => toolPoint(machine, q, length, found), errorsAt,
  bodyPoses: (q, found = null) => bodyPoses(machine, q, found) };
