// The frame of a plot: a canvas with its axes, from numbers to pixels and back.

import { colour } from "./theme.js";
import { fixed, ticks } from "./numbers.js";

export class Frame {
  constructor(canvas, { left = 52, right = 12, top = 10, bottom = 38 } = {}) {
    Object.assign(this, { canvas, left, least: left, right, top, bottom, xLabel: "", yLabel: "" });
    this.context = canvas.getContext("2d");
    this.x = [0, 1];
    this.y = [0, 1];
  }

  /** Size as the page has it, in CSS pixels; false while the element has none. */
  begin() {
    const { canvas, context } = this, ratio = window.devicePixelRatio || 1;
    this.wide = canvas.clientWidth;
    this.high = canvas.clientHeight;
    if (!this.wide || !this.high) return false;
    const [w, h] = [Math.round(this.wide * ratio), Math.round(this.high * ratio)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.wide, this.high);
    const size = Math.max(12, 0.86 * parseFloat(getComputedStyle(canvas).fontSize));
    context.font = `${size}px system-ui, 'Segoe UI', Arial, sans-serif`;
    return true;
  }

  /** Pixel of a number. */
  px(v) {
    const [low, high] = this.x;
    return this.left + (v - low) / (high - low) * (this.wide - this.left - this.right);
  }

  py(v) {
    const [low, high] = this.y;
    return this.high - this.bottom - (v - low) / (high - low) * (this.high - this.top - this.bottom);
  }

  /** Number at a pixel. */
  vx(p) {
    const [low, high] = this.x;
    return low + (p - this.left) / (this.wide - this.left - this.right) * (high - low);
  }

  vy(p) {
    const [low, high] = this.y, span = this.high - this.top - this.bottom;
    return low + (this.high - this.bottom - p) / span * (high - low);
  }

  /** Grid, numbers and labels. names: words at 0, 1, 2 ... in place of the numbers below. */
  axes({ names = null } = {}) {
    const { context: c } = this, y0 = this.high - this.bottom;
    c.lineWidth = 1;
    c.strokeStyle = colour("line");
    c.fillStyle = colour("soft");
    c.textAlign = "right";
    c.textBaseline = "middle";
    const up = ticks(...this.y, Math.max(3, Math.floor(this.high / 32)));
    const widest = Math.max(...up.at.map(v => c.measureText(fixed(v, up.places)).width));
    this.left = Math.max(this.least, Math.ceil(widest) + (this.yLabel ? 28 : 12));
    const x0 = this.left;
    for (const v of up.at) {
      const p = Math.round(this.py(v)) + 0.5;
      c.beginPath();
      c.moveTo(x0, p);
      c.lineTo(this.wide - this.right, p);
      c.stroke();
      c.fillText(fixed(v, up.places), x0 - 6, p);
    }
    c.textAlign = "center";
    c.textBaseline = "top";
    if (names) this.words(names, y0);
    else {
      const across = ticks(...this.x, Math.max(2, Math.floor(this.wide / 80)));
      for (const v of across.at) c.fillText(fixed(v, across.places), this.px(v), y0 + 5);
    }
    c.fillStyle = colour("ink");
    c.fillText(this.xLabel, (x0 + this.wide - this.right) / 2, this.high - 15);
    c.save();
    c.translate(11, (this.top + y0) / 2);
    c.rotate(-Math.PI / 2);
    c.textBaseline = "middle";
    c.fillText(this.yLabel, 0, 0);
    c.restore();
  }

  words(names, y0) {
    const room = (this.wide - this.left - this.right) / names.length;
    const widest = Math.max(...names.map(n => this.context.measureText(n).width)) + 8;
    const every = Math.max(1, Math.ceil(widest / room));
    for (let k = 0; k < names.length; k += every) {
      this.context.fillText(names[k], this.px(k), y0 + 5);
    }
  }
}
