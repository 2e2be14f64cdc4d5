// The standard in space: what was touched, every touch in the colour of its residual, arrows.

import { element, slider } from "../parts/elements.js";
import { digits, signed } from "../parts/numbers.js";
import { bytes, colour } from "../parts/theme.js";
import { showTriad } from "../parts/triad.js";
import { View3D, rgb } from "../parts/view3d.js";

const MOST = 2.5;  // of the scale's end, the longest arrow
const MANY = 5000;  // touches from which they are drawn small and plain
const ARROW = 0.05;  // length of the arrow of the largest residual, over the size of the scene

export class Touched {
  constructor(place, data, { mark, choose }) {
    Object.assign(this, { data, mark: m => this.ring(m), onMark: mark, choose, stretch: 1 });
    this.place = place;
    this.canvas = element("canvas", {
      role: "img", "aria-label": "Touched points in the frame of the standard, coloured by "
        + "residual. Arrow keys turn, shift and arrows move, plus and minus zoom, 0 shows all.",
    });
    this.hint = element("div", { class: "tip", hidden: true });
    this.legend = element("div", { class: "legend" });
    const length = slider({
      label: "arrows", low: 0, high: 10, value: 1, step: 0.05, words: v => `× ${v.toFixed(1)}`,
      input: v => { this.stretch = v; this.drawArrows(); },
    });
    const all = element("button", { type: "button", text: "show all",
      onclick: () => { this.view.camera.reset(); this.view.request(); } });
    place.append(this.canvas, this.hint,
      element("div", { class: "below" }, this.legend, length, all));
    this.made();
  }

  made() {
    const { data } = this, t = data.touches, n = t.count, isMany = n > MANY;
    this.view = new View3D(this.canvas, { camera: { turn: -1.1, tilt: 0.55 }, isSmooth: !isMany });
    this.view.layers = [];
    this.body = data.body && this.view.mesh({ corners: data.body.values });
    this.dots = this.view.points({ positions: t.point.values, colours: new Uint8Array(3 * n),
      size: isMany ? 4 : 7 });
    this.view.fit();
    this.arrows = this.view.lines({ positions: new Float32Array(6 * n), size: isMany ? 1 : 2,
      colours: new Uint8Array(3 * n) });
    this.circle = this.view.points({ positions: new Float32Array(3), colours: new Uint8Array(3),
      size: 13, isVisible: false, isPickable: false });
    showTriad(this.view);
    this.recolour();
    this.canvas.addEventListener("pointermove", e => this.over(e));
    this.canvas.addEventListener("pointerleave", () => this.onMark(-1));
    let pressed = null;
    this.canvas.addEventListener("pointerdown", e => { pressed = [e.offsetX, e.offsetY]; });
    this.canvas.addEventListener("click", e => {
      if (pressed && Math.hypot(e.offsetX - pressed[0], e.offsetY - pressed[1]) > 4) return;
      this.chosenFeature(e);
    });
  }

  recolour() {
    this.view.ground = colour("wash");
    if (this.body) this.body.colour = rgb(colour("body"));
    this.view.request();
  }

  over(e) {
    if (e.buttons) return;
    const found = this.view.pick(e.offsetX, e.offsetY);
    this.onMark(found && found.layer === this.dots ? found.index : -1);
  }

  /** A click on a touch chooses its feature; beside all, nothing. */
  chosenFeature(e) {
    const found = this.view.pick(e.offsetX, e.offsetY), { feature, count } = this.data.touches;
    if (!found || found.layer !== this.dots) {
      this.choose(null);
      return;
    }
    const own = feature.values[found.index];
    this.choose(Array.from({ length: count }, (_, i) => i).filter(i => feature.values[i] === own));
  }

  show(shown) {
    this.shown = shown;
    const { colours, chosen } = shown, faint = bytes(colour("line"));
    const out = Uint8Array.from(colours);
    if (chosen) {
      for (let i = 0; i < this.data.touches.count; i++) {
        if (!chosen.has(i)) for (let k = 0; k < 3; k++) out[3 * i + k] = faint[k];
      }
    }
    this.dots.set("colours", out);
    this.arrows.set("colours", out);
    this.drawArrows();
    const { limit } = shown, { unit } = this.data;
    const scale = element("i", { class: "scale" });
    const hasGross = this.data.touches.state.values.includes(1);
    this.legend.replaceChildren(`residual −${digits(limit, 2)}`, scale, `+${digits(limit, 2)} ${unit}`,
      ...(hasGross ? [element("i", { class: "gross" }), "gross error"] : []));
    this.legend.title = "measured minus predicted; the scale is that of the starting model";
  }

  drawArrows() {
    const { point, normal, count, state } = this.data.touches, { residual, limit } = this.shown;
    const unit = ARROW * this.view.camera.size * this.stretch / limit, out = this.arrows.positions;
    for (let i = 0; i < count; i++) {
      const most = state.values[i] === 1 ? 0 : MOST * limit;  // gross errors have no arrow
      const high = Math.max(-most, Math.min(most, residual[i]));
      for (let k = 0; k < 3; k++) {
        const from = point.values[3 * i + k];
        out[6 * i + k] = from;
        out[6 * i + 3 + k] = from + unit * high * normal.values[3 * i + k];
      }
    }
    this.arrows.isVisible = this.stretch > 0;
    this.arrows.set("positions", out);
  }

  ring({ marked, residual, now }) {
    this.circle.isVisible = marked >= 0;
    this.hint.hidden = marked < 0;
    if (marked >= 0) {
      this.circle.positions = this.data.touches.point.values.slice(3 * marked, 3 * marked + 3);
      this.circle.set("colours", Uint8Array.from(bytes(colour("ink"))));
      this.circle.set("positions", this.circle.positions);
      this.hint.textContent = described(this.data, marked, residual, now);
    }
    this.view.request();
  }
}

/** A touch in a line: number, feature, line, pose, reading, residual with its uncertainty. */
export function described(data, i, residual, now) {
  const t = data.touches, state = ["", "; gross error, left out", "; held out"][t.state.values[i]];
  const feature = t.features[t.feature.values[i]];
  const setup = t.setups.length > 1 ? `, set-up ${t.setups[t.setup.values[i]]}` : "";
  const readings = data.columns.filter(c => / in (mm|°)$/.test(c.name) && c.name.length < 9)
    .map(c => `${c.name.replace(/ in .*/, "")} ${digits(c.values[i], 4)}`).join(" ");
  const program = programmed(t, i);
  return `touch ${i + 1}${feature ? ` on ${feature}` : ""}, line ${t.line.values[i]}${setup}, pose `
    + `${t.pose.values[i]}${program ? `; ${program}` : ""}; ${readings}; measured ${signed(t.measured.values[i])}, residual `
    + `${signed(residual[i])} ± ${digits(t.u.values[i] * now.s, 2)} ${data.unit}${state}`;
}

/** `MS_A_1 touch 37, line 412`: where a touch stands in its program; "" where the run has no such. */
export function programmed(touches, i) {
  const { programs, program, number, programLine } = touches;
  const name = programs.length ? programs[program.values[i]] : "";
  if (!name) return "";
  const line = programLine.values[i];
  return `${name}${number.values[i] ? ` touch ${number.values[i]}` : ""}${line ? `, line ${line}` : ""}`;
}
