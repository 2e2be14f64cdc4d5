// The live page of a run: effects to switch, the standard with its residuals, errors.

import { pageData } from "../parts/data.js";
import { EffectBoard } from "../parts/effect_board.js";
import { element } from "../parts/elements.js";
import { showLadder } from "../parts/ladder.js";
import { fixed, quantile } from "../parts/numbers.js";
import { foldStill } from "../parts/still.js";
import { bytes, colour, signedColours, themeButton } from "../parts/theme.js";
import { EffectList } from "./run_effects.js";
import { Residuals } from "./run_residuals.js";
import { Touched } from "./run_touched.js";

const data = await pageData(), board = new EffectBoard(data);
const place = document.getElementById("live");
const words = v => fixed(v, v < 10 ? 3 : 2);

/** What is shown now: residuals, their colours, the touch under the pointer, the touches chosen. */
const shown = { residual: null, colours: null, limit: 1, marked: -1, chosen: null, now: null };
const start = board.errors([]);
const counted = v => v.filter((_, i) => data.touches.state.values[i] !== 1);  // no gross errors
shown.limit = quantile(counted(board.residuals(start)).map(Math.abs), 0.98) || 1;

/** The view takes what the text above leaves of the window. */
function sized() {
  place.style.setProperty("--above", `${Math.ceil(place.getBoundingClientRect().top + scrollY)}px`);
}

function laidOut() {
  const theme = element("button", { type: "button", id: "theme" });
  const again = element("button", {
    type: "button", id: "again", title: "every effect as the command left it",
    text: !board.switches.some(s => s.isFound) ? "all off"
      : data.isPrediction ? "as predicted" : "as found",
    onclick: () => { board.reset(); effects.refresh(); changed(); },
  });
  const figures = element("p", { class: "figures", role: "status", "aria-live": "polite" });
  place.append(
    element("div", { class: "panel effects" },
      element("div", { class: "bar-of-buttons" },
        element("h2", { text: "Effects" }), again, theme),
      element("p", { class: "hint", text: `${data.isPrediction
        ? "The geometry is predicted by the model; a switch fits the set-ups again."
        : "A switch fits the model again, geometry and set-ups with it."} In grey: the held-out `
        + "error that the switch leads to." }),
      element("div", { id: "effect-list" })),
    element("div", { class: "panel touched" }),
    element("div", { class: "panel residuals" }),
    element("div", { class: "panel errors" },
      figures,
      element("ol", { class: "ladder", role: "img" }),
      element("h3", { id: "by-pose-title" }),
      element("canvas", { id: "by-pose", role: "img", "aria-label": "Held-out error by pose" }),
      element("div", { id: "chosen" })));
  return { theme, figures, ladder: place.querySelector(".ladder") };
}

/** Fits the set that is on, and shows it; switches that are off show their effect later. */
function changed() {
  const begun = performance.now();
  shown.now = board.errors();
  shown.residual = board.residuals(shown.now);
  painted();
  effects.turn = null;  // what switches would bring is out of date
  effects.show(shown.now);
  ladder();
  place.dataset.milliseconds = (performance.now() - begun).toFixed(1);
  clearTimeout(waiting);
  waiting = setTimeout(() => effects.scents(), 30);
}

function painted() {
  shown.colours = signedColours(shown.residual, shown.limit);
  const gross = bytes(colour("ink")), { state, count } = data.touches;
  for (let i = 0; i < count; i++) if (state.values[i] === 1) shown.colours.set(gross, 3 * i);
  touched.show(shown);
  residuals.show(shown);
}

function ladder() {
  const { now } = shown, unit = data.unit;
  const on = board.on, hasOwn = board.switches.some(s => s.isFound);
  const first = !data.isPrediction ? "starting model" : hasOwn ? "model without its effects"
    : "the model";
  const rungs = [{ name: first, ...start }];
  for (let k = 1; k <= on.length; k++) {
    const last = k === on.length;
    rungs.push({ name: `+ ${on[k - 1].title}`, ...(last ? now : board.errors(on.slice(0, k))) });
  }
  rungs[rungs.length - 1].isNow = true;
  if (hasOwn && !now.isAsFound) rungs.push({ name: data.isPrediction ? "as predicted" : "as found", ...board.asFound() });
  const most = 1.05 * Math.max(...rungs.map(r => Math.max(r.heldOut, r.fitted)), data.noise);
  showLadder(parts.ladder, { rungs, noise: data.noise, most, words, unit });
  const pinned = on.some(s => s.gain !== null);
  parts.figures.replaceChildren(...[
    element("span", {}, "fitted ", element("b", { id: "fitted", text: words(now.fitted) })),
    element("span", {}, "held out ", element("b", { id: "held-out", text: words(now.heldOut) })),
    element("span", { text: `${unit} rms` }),
    data.setUpAlone === null ? null
      : element("span", { text: `held out without any model of the machine ${words(data.setUpAlone)} ${unit}` }),
    pinned ? element("span", { class: "warn", text: "the held-out error does not count the gain that you set" }) : null,
  ].filter(Boolean));
  Object.assign(place.dataset, { fitted: now.fitted, heldOut: now.heldOut, noise: now.s });
}

/** Touches that are pointed at or chosen, in every picture. */
function mark(index) {
  if (index === shown.marked) return;
  shown.marked = index;
  touched.mark(shown);
  residuals.mark(shown);
}

function choose(rows) {
  shown.chosen = rows && rows.length ? new Set(rows) : null;
  touched.show(shown);
  residuals.show(shown);
}

place.hidden = false;
place.classList.toggle("placeless", !data.touches.isSpread);  // readings at one place: no picture
sized();
addEventListener("resize", sized);
const parts = laidOut();
let waiting = 0;
const effects = new EffectList(place.querySelector("#effect-list"), board, data, changed);
const touched = new Touched(place.querySelector(".touched"), data, { mark, choose });
const residuals = new Residuals(place, board, { mark, choose });
effects.refresh();
changed();
themeButton(parts.theme, () => { touched.recolour(); painted(); });
foldStill();
addEventListener("keydown", e => { if (e.key === "Escape") choose(null); });
window.livePage = { board, data, shown, changed, choose, mark, touched, residuals, effects };
