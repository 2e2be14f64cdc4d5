// A standard with its features, its touches and the probe; features are pointed at and chosen.

import { showTriad } from "./triad.js";
import { View3D, rgb } from "./view3d.js";
import { bytes, colour } from "./theme.js";

const STILL = 4;  // pixels: a pointer that moved less has pointed, not turned
const FAINT = 0.35;  // of the colours of what is not chosen

export class StandardView {
  /** picked(name): a feature was pointed at, "" for none. */
  constructor(canvas, data, picked) {
    Object.assign(this, { data, chosen: "", shownBodies: [] });
    this.view = new View3D(canvas, { camera: { turn: -1.0, tilt: 0.6 } });
    this.features = data.features.map(one => ({
      ...one, own: rgb(one.colour), layer: this.view.mesh({ corners: one.corners.values,
        colour: rgb(one.colour), isPickable: true }),
    }));
    this.own = this.features.map(f => f.layer);
    const { point } = data.touches, count = point.values.length / 3;
    this.dots = this.view.points({ positions: point.values, colours: new Uint8Array(3 * count),
      size: 6 });
    this.probe = this.view.mesh({ corners: data.probe.values, colour: rgb("#5c6878"),
      isVisible: false });
    let from = null;
    canvas.addEventListener("pointerdown", e => { from = [e.clientX, e.clientY]; });
    canvas.addEventListener("pointerup", e => {
      const isStill = from && Math.hypot(e.clientX - from[0], e.clientY - from[1]) < STILL;
      from = null;
      if (isStill) picked(this.under(e.offsetX, e.offsetY));
    });
    this.view.fit();
    showTriad(this.view);
    this.recolour();
  }

  /** Name of the feature at a point of the element. */
  under(x, y) {
    const found = this.view.pick(x, y), { names, feature } = this.data.touches;
    if (!found) return "";
    if (found.layer === this.dots) return names[feature.values[found.index]];
    const under = this.features.find(f => f.layer === found.layer);
    return under ? under.name : "";
  }

  recolour() {
    this.view.ground = colour("ground");
    this.choose(this.chosen);
  }

  /** Brings one feature out: the others are pale. */
  choose(name) {
    this.chosen = name;
    const ground = rgb(this.view.ground);
    for (const { layer, own, name: its } of this.features) {
      const share = !name || its === name ? 1 : FAINT;
      layer.colour = own.map((v, k) => share * v + (1 - share) * ground[k]);
    }
    const { feature, names } = this.data.touches, on = bytes(colour("bad"));
    const off = bytes(colour("soft")), out = new Uint8Array(3 * feature.values.length);
    for (let i = 0; i < feature.values.length; i++) {
      const isOn = name && names[feature.values[i]] === name;
      for (let k = 0; k < 3; k++) out[3 * i + k] = isOn ? on[k] : off[k];
    }
    this.dots.set("colours", out);
  }

  /** The probe at a touch; -1 takes it away. */
  touch(row) {
    this.probe.isVisible = row >= 0;
    if (row >= 0) {
      const T = this.data.touches.tool.values.subarray(12 * row, 12 * row + 12);
      const m = new Float32Array(16);
      for (let c = 0; c < 4; c++) m.set(T.subarray(3 * c, 3 * c + 3), 4 * c);
      m[15] = 1;
      this.probe.place = m;
    }
    this.view.request();
  }

  /** Another artefact in place of the standard; its bodies and the places of its touches. */
  show(rival) {
    for (const layer of this.shownBodies) this.view.remove(layer);
    for (const layer of this.own) layer.isVisible = rival.is_own;
    this.dots.isVisible = rival.is_own;
    this.probe.isVisible = false;
    this.shownBodies = rival.is_own ? [] : rival.bodies.map(b => this.view.mesh({
      corners: b.corners.values, colour: rgb(b.colour) }));
    if (!rival.is_own) {
      const count = rival.point.values.length / 3, colours = new Uint8Array(3 * count);
      const tint = bytes(colour("bad"));
      for (let i = 0; i < colours.length; i++) colours[i] = tint[i % 3];
      this.shownBodies.push(this.view.points({ positions: rival.point.values, colours, size: 5,
        isPickable: false }));
    }
    this.view.request();
  }
}
