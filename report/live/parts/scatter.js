// Dots over two numbers, in the colours of their values; pointing at one, and brushing a rectangle.

import { colour } from "./theme.js";
import { Frame } from "./frame.js";

const BINS = 32;  // colours that are distinguished: a change of style for each dot takes 5 times longer

export class Scatter {
  /** over(index or -1): the dot under the pointer; brushed(indices or null): the rectangle. */
  constructor(canvas, { over = () => {}, brushed = () => {}, ...frame } = {}) {
    this.frame = new Frame(canvas, frame);
    Object.assign(this, { canvas, over, brushed, band: 0, marked: -1, chosen: null, held: null });
    this.x = this.y = new Float32Array(0);
    this.colours = new Uint8Array(0);
    canvas.addEventListener("pointerdown", e => this.press(e));
    canvas.addEventListener("pointermove", e => this.move(e));
    canvas.addEventListener("pointerup", () => this.release());
    canvas.addEventListener("pointerleave", () => this.held || over(-1));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /**
   * x, y: numbers; colours: three bytes each; xRange, yRange: [low, high]; band: half a width;
   * curve: { x, y, half } drawn over the dots, half the width of its band, or null.
   */
  show({ x = this.x, y = this.y, colours = this.colours, xRange, yRange, band = this.band,
    curve = null }) {
    Object.assign(this, { x, y, colours, band, curve });
    if (xRange) this.frame.x = padded(xRange);
    if (yRange) this.frame.y = padded(yRange);
    this.draw();
  }

  draw() {
    const { frame } = this, c = frame.context;
    if (!frame.begin()) return;
    if (this.band) {
      c.fillStyle = colour("noise");
      const top = Math.max(frame.top, frame.py(this.band));
      const low = Math.min(frame.high - frame.bottom, frame.py(-this.band));
      c.fillRect(frame.left, top, frame.wide - frame.left - frame.right, low - top);
    }
    frame.axes();
    c.save();
    c.beginPath();
    c.rect(frame.left - 4, frame.top - 4, frame.wide - frame.left - frame.right + 8,
      frame.high - frame.top - frame.bottom + 8);
    c.clip();
    this.dots(c);
    if (this.curve) this.line(c);
    if (this.marked >= 0) this.ring(c, this.marked);
    if (this.held && this.held.to) {
      const [[a, b], [x, y]] = [this.held.from, this.held.to];
      c.strokeStyle = c.fillStyle = colour("mark");
      c.strokeRect(a, b, x - a, y - b);
      c.globalAlpha = 0.12;
      c.fillRect(a, b, x - a, y - b);
    }
    c.restore();
  }

  dots(c) {
    const { x, y, colours, chosen } = this, groups = new Map(), size = x.length > 5000 ? 3 : 5;
    for (let i = 0; i < x.length; i++) {
      if (!Number.isFinite(x[i]) || !Number.isFinite(y[i])) continue;
      const faint = chosen && !chosen.has(i) ? 1 : 0;
      const step = 256 / BINS;
      const key = faint * 2 ** 24 + (Math.floor(colours[3 * i] / step) << 16)
        + (Math.floor(colours[3 * i + 1] / step) << 8) + Math.floor(colours[3 * i + 2] / step);
      if (!groups.has(key)) groups.set(key, []);
      groups.get(key).push(i);
    }
    for (const [key, members] of [...groups].sort((a, b) => b[0] - a[0])) {
      const rgb = members[0] * 3;
      c.globalAlpha = key >= 2 ** 24 ? 0.15 : 0.9;
      c.fillStyle = `rgb(${colours[rgb]},${colours[rgb + 1]},${colours[rgb + 2]})`;
      for (const i of members) {
        c.fillRect(this.frame.px(x[i]) - size / 2, this.frame.py(y[i]) - size / 2, size, size);
      }
    }
    c.globalAlpha = 1;
  }

  line(c) {
    const { frame, curve: { x, y, half } } = this, at = (i, v) => [frame.px(x[i]), frame.py(v)];
    c.fillStyle = c.strokeStyle = colour("ink");
    c.beginPath();
    for (let i = 0; i < x.length; i++) c.lineTo(...at(i, y[i] + half[i]));
    for (let i = x.length - 1; i >= 0; i--) c.lineTo(...at(i, y[i] - half[i]));
    c.globalAlpha = 0.18;
    c.fill();
    c.globalAlpha = 1;
    c.lineWidth = 2;
    c.beginPath();
    for (let i = 0; i < x.length; i++) c.lineTo(...at(i, y[i]));
    c.stroke();
  }

  ring(c, i) {
    if (!Number.isFinite(this.x[i]) || !Number.isFinite(this.y[i])) return;
    c.strokeStyle = colour("ink");
    c.lineWidth = 2;
    c.beginPath();
    c.arc(this.frame.px(this.x[i]), this.frame.py(this.y[i]), 7, 0, 2 * Math.PI);
    c.stroke();
  }

  /** Index of the dot nearest to a pixel within 12, or -1. */
  nearest(px, py) {
    let best = -1, least = 144;
    for (let i = 0; i < this.x.length; i++) {
      const away = (this.frame.px(this.x[i]) - px) ** 2 + (this.frame.py(this.y[i]) - py) ** 2;
      if (away < least) [best, least] = [i, away];
    }
    return best;
  }

  press(e) {
    if (e.button) return;
    this.canvas.setPointerCapture(e.pointerId);
    this.held = { from: [e.offsetX, e.offsetY], to: null };
  }

  move(e) {
    if (!this.held) {
      this.over(this.nearest(e.offsetX, e.offsetY));
      return;
    }
    this.held.to = [e.offsetX, e.offsetY];
    this.draw();
  }

  release() {
    const { held, frame } = this;
    this.held = null;
    if (!held) return;
    if (!held.to || Math.hypot(held.to[0] - held.from[0], held.to[1] - held.from[1]) < 5) {
      this.brushed(null);
      return;
    }
    const across = [held.from[0], held.to[0]].map(p => frame.vx(p)).sort((a, b) => a - b);
    const up = [held.from[1], held.to[1]].map(p => frame.vy(p)).sort((a, b) => a - b);
    const found = [];
    for (let i = 0; i < this.x.length; i++) {
      const isIn = this.x[i] >= across[0] && this.x[i] <= across[1]
        && this.y[i] >= up[0] && this.y[i] <= up[1];
      if (isIn) found.push(i);
    }
    this.brushed(found);
  }
}

/** A range with a little room at its ends; of one number, some around it. */
export function padded([low, high]) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  const span = high - low || Math.abs(high) || 1;
  return [low - 0.03 * span, high + 0.03 * span];
}
