// The page of a design: the standard, its touches, other artefacts, the error field, sensitivities.

import { axisOrder } from "../parts/axis_order.js";
import { pageData } from "../parts/data.js";
import { element, slider, toggle } from "../parts/elements.js";
import { digits, fixed, quantile, rms } from "../parts/numbers.js";
import { SensitivityList } from "../parts/sensitivity_list.js";
import { StandardView } from "../parts/standard_view.js";
import { foldStill } from "../parts/still.js";
import { themeButton } from "../parts/theme.js";
import { VolumeCut } from "../parts/volume_cut.js";

const DEG = Math.PI / 180, PACE = 4;  // touches in a second while they are played

const data = await pageData(), byId = id => document.getElementById(id);
byId("design").hidden = false;
const standard = new StandardView(byId("standard"), data, choose);

// ---- features

const names = data.features.map(f => f.name).filter(Boolean);
const chosen = element("select", { "aria-label": "feature", onchange: () => choose(chosen.value) },
  element("option", { text: "choose a face or a ball", value: "" }),
  ...names.map(name => element("option", { text: name, value: name })));
byId("choice").append(chosen);

function choose(name) {
  chosen.value = name;
  standard.choose(name);
  byId("feature").replaceChildren(...about(name).map(text => element("p", { text })));
}

/** What a feature is for, its touches, its share. */
function about(name) {
  const one = data.features.find(f => f.name === name);
  if (!name || !one) {
    return [`${names.length} features, ${data.touches.feature.values.length} touches.`];
  }
  const said = [`${name}: ${one.touches} touches of ${data.touches.feature.values.length}.`];
  if (one.kind === "face") {
    said.push("A freeform face proves: its touches are held out of the identification, and a wrong "
      + "model shows on them.");
    if (one.errors.length) {
      said.push(`Dominant errors, as shares of its signal: ${one.errors.map(
        e => `${e.name} ${fixed(100 * e.share, 0)} %`).join(", ")}.`);
    }
  } else {
    said.push("A ball identifies: its touches determine the model of the machine.");
    if (one.without_um !== null) {
      const more = 100 * (one.without_um / data.with_all_um - 1);
      said.push(`Without its touches ${digits(one.without_um)} µm of the tool point in your `
        + `workspace stay unknown, with them ${digits(data.with_all_um)} µm: it is worth `
        + `${digits(more, 2)} %.`);
    }
  }
  return said;
}

// ---- touches in their order

const { touches } = data, count = touches.feature.values.length;
let at = -1, timer = 0;
const play = element("button", { type: "button", text: "play", "aria-label": "play the touches",
  onclick: () => (timer ? halt() : start()) });
const touch = slider({ label: "touch", low: 0, high: count, value: 0, step: 1,
  words: v => (v ? `${v} of ${count}` : "none"), input: v => {
    halt();
    go(v - 1);
  } });
touch.range.id = "touch";
byId("touches").append(play, touch);

function start() {
  play.textContent = "stop";
  if (at >= count - 1) at = -1;
  timer = setInterval(() => (at < count - 1 ? go(at + 1) : halt()), 1000 / PACE);
}

function halt() {
  clearInterval(timer);
  timer = 0;
  play.textContent = "play";
}

function go(row) {
  at = row;
  touch.set(row + 1);
  standard.touch(row);
  if (row < 0) {
    byId("touched").textContent = "";
    return;
  }
  const readings = touches.rotary_names.map((axis, k) => `${axis} ${fixed(
    touches.rotary.values[row * touches.rotary_names.length + k], 1)}°`).join(", ");
  const feature = touches.names[touches.feature.values[row]];
  const why = touches.is_anchor.values[row] ? ", the datum touch of its visit" : "";
  byId("touched").textContent = `Touch ${row + 1} on ${feature}${why}; visit `
    + `${touches.visit.values[row] + 1}${readings ? `, ${readings}` : ""}.`;
}

// ---- other artefacts

const worst = Math.max(...data.rivals.map(r => r.user_um));
byId("rivals").append(...data.rivals.map((rival, k) => {
  const radio = element("input", { type: "radio", name: "rival", value: k,
    onchange: () => show(rival) });
  radio.checked = rival.is_own;
  const words = [`${rival.visible} of ${rival.could_be_visible} further effects visible`,
    rival.minutes === null ? null : `${fixed(rival.minutes, 0)} min`,
    `${digits(rival.volume_um)} µm in the probed volume`].filter(Boolean);
  return element("li", {}, element("label", { class: "toggle" }, radio,
    element("span", { text: rival.name })),
  element("div", { class: "bar held" }, element("i", {
    style: `width:${100 * rival.user_um / worst}%` }),
  element("span", { text: `${digits(rival.user_um)} µm` })),
  element("small", { text: words.join("; ") }));
}));

function show(rival) {
  halt();
  go(-1);
  standard.show(rival);
  for (const id of ["touches", "choice"]) byId(id).hidden = !rival.is_own;
  byId("feature").replaceChildren(element("p", { text: rival.is_own ? about("")[0]
    : `${rival.name}: ${rival.bodies.length ? "as the optimiser places it under the same rules"
      : "touches in space, without a body"}; red: its touches.` }));
}

// ---- the error field

let cut = null;
const field = { place: 0, axis: 2, rotary: 0, isAfter: false, stretch: 1 };

function drawCut() {
  const { before, after, at: grid } = data.field, size = grid.reduce((n, a) => n * a.length, 3);
  const values = (field.isAfter ? after : before).values.subarray(field.rotary * size,
    (field.rotary + 1) * size);
  const most = quantile(lengths(before.values), 0.98) || 1;
  cut.show(cut.cut(values, field.axis, field.place), most, field.stretch);
  byId("of-field").textContent = `${field.isAfter ? "After" : "Before"} identification: `
    + `${digits(rms(lengths(values).filter(Number.isFinite)))} µm rms in this volume.`;
  byId("of-colours").replaceChildren("length of the error: 0", element("i"), `${digits(most)} µm`);
}

/** Of vectors, three numbers each. */
function lengths(vectors) {
  return Float64Array.from({ length: vectors.length / 3 },
    (_, i) => Math.hypot(...vectors.subarray(3 * i, 3 * i + 3)));
}

function makeCut() {
  const { at: grid, axes, rotary } = data.field;
  cut = new VolumeCut(byId("field"), grid, axes);
  const middle = a => (a[0] + a[a.length - 1]) / 2;
  field.place = middle(grid[field.axis]);
  const place = slider({ label: "cut at", low: 0, high: 1, value: 0.5, step: 0.005,
    words: v => {
      const a = grid[field.axis];
      return `${axes[field.axis]} ${fixed(a[0] + v * (a[a.length - 1] - a[0]), 0)} mm`;
    }, input: v => {
      const a = grid[field.axis];
      field.place = a[0] + v * (a[a.length - 1] - a[0]);
      drawCut();
    } });
  place.range.id = "cut";
  const across = element("select", { "aria-label": "cut across", onchange: () => {
    field.axis = Number(across.value);
    field.place = middle(grid[field.axis]);
    place.set(0.5);
    drawCut();
  } }, ...axes.map((a, k) => element("option", { text: `across ${a}`, value: k })));
  across.value = field.axis;
  const words = one => Object.entries(one).map(([a, v]) => `${a} ${fixed(v, 0)}°`).join(", ");
  const turned = element("select", { "aria-label": "rotary axes at", onchange: () => {
    field.rotary = Number(turned.value);
    drawCut();
  } }, ...rotary.map((one, k) => element("option", { text: words(one), value: k })));
  const after = toggle({ label: "after identification", changed: v => {
    field.isAfter = v;
    drawCut();
  } });
  after.box.id = "after";
  const stretch = slider({ label: "arrows", low: 0, high: 2, value: 0,
    words: v => `× ${digits(10 ** v, 2)}`, input: v => {
      field.stretch = 10 ** v;
      drawCut();
    } });
  stretch.range.id = "stretch";
  byId("cuts").append(after, across, ...(words(rotary[0]) ? [turned] : []), place, stretch);
  drawCut();
}

// ---- sensitivities

const { machine, axes } = data;
const q = Float64Array.from(axes, a => Math.min(Math.max(0, a.low), a.high));
const list = new SensitivityList(byId("sensitivities"), machine, data.symbols,
  axes.map(a => a.name));
byId("readings").append(...axisOrder(axes).map(k => {
  const axis = axes[k], unit = axis.is_rotary ? DEG : 1;
  const made = slider({ label: axis.name, low: axis.low / unit, high: axis.high / unit,
    value: q[k] / unit, step: 0.1, words: v => `${fixed(v, 1)} ${axis.is_rotary ? "°" : "mm"}`,
    input: v => {
      q[k] = v * unit;
      list.show(q, data.length);
    } });
  made.range.id = `reading-${axis.name}`;
  return made;
}));

if (data.field) makeCut();
choose("");
foldStill();
themeButton(byId("theme"), () => {
  standard.recolour();
  if (cut) {
    cut.recolour();
    drawCut();
  }
});
list.show(q, data.length);

window.designPage = { data, standard, choose, go, field, q, cut: () => cut };
