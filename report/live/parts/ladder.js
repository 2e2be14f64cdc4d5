// The ladder: the error after each step, as bars against the noise; fitted and held out.

import { element } from "./elements.js";

/**
 * Shows rungs in an element. rungs: [{ name, fitted, heldOut, isNow }] of numbers in one unit;
 * noise: level, or null; most: end of the scale; words(value): a figure as it is said.
 */
export function showLadder(place, { rungs, noise, most, words, unit }) {
  const share = v => `${Math.max(0, Math.min(100, 100 * v / most))}%`;
  const bar = (kind, value, label) => element("div", { class: `bar ${kind}` },
    element("i", { style: `width:${share(value)}` }),
    noise === null ? null : element("u", { style: `left:${share(noise)}` }),
    element("span", { text: `${label} ${words(value)}` }));
  const said = rungs.map(r => `${r.name}: fitted ${words(r.fitted)}, held out ${words(r.heldOut)} `
    + unit).join("; ");
  place.setAttribute("aria-label", `${said}${noise === null ? "" : `; noise ${words(noise)} ${unit}`}`);
  const key = noise === null ? null : element("li", { class: "key" }, element("u", {}),
    `stated noise ${words(noise)} ${unit}`);
  place.replaceChildren(...rungs.map(r => element("li", { class: r.isNow ? "now" : null },
    element("b", { text: r.name }), bar("held", r.heldOut, "held out"),
    bar("fitted", r.fitted, "fitted"))), ...(key ? [key] : []));
}
