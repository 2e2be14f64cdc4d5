// Bars side by side, one for each of many things, with a line across them.

import { colour } from "./theme.js";
import { Frame } from "./frame.js";

export class Bars {
  /** over(index or -1), pressed(index): the bar under the pointer. */
  constructor(canvas, { over = () => {}, pressed = () => {}, ...frame } = {}) {
    this.frame = new Frame(canvas, frame);
    Object.assign(this, { canvas, values: [], names: [], line: null, marked: -1, top: 1 });
    const at = e => {
      const k = Math.round(this.frame.vx(e.offsetX));
      return k >= 0 && k < this.values.length ? k : -1;
    };
    canvas.addEventListener("pointermove", e => over(at(e)));
    canvas.addEventListener("pointerleave", () => over(-1));
    canvas.addEventListener("click", e => at(e) >= 0 && pressed(at(e)));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** values; names below; before: faint values behind; line: a level across; top of the scale. */
  show({ values = this.values, names = this.names, before = this.before, line = this.line,
    top = this.top, marked = this.marked }) {
    Object.assign(this, { values, names, before, line, top, marked });
    this.draw();
  }

  draw() {
    const { frame, values } = this, c = frame.context;
    if (!frame.begin()) return;
    frame.x = [-0.6, Math.max(values.length - 0.4, 0.6)];
    frame.y = [0, 1.05 * this.top];
    frame.axes({ names: this.names });
    const wide = Math.max(1, 0.8 * (frame.px(1) - frame.px(0))), foot = frame.py(0);
    const bar = (k, v, fill) => {
      if (!Number.isFinite(v)) return;
      const top = Math.max(frame.top, frame.py(v));
      c.fillStyle = fill;
      c.fillRect(frame.px(k) - wide / 2, top, wide, foot - top);
    };
    if (this.before) this.before.forEach((v, k) => bar(k, v, colour("line")));
    values.forEach((v, k) => bar(k, v, colour(k === this.marked ? "ink" : "mark")));
    if (this.line === null) return;
    c.strokeStyle = colour("good");
    c.lineWidth = 1.5;
    c.setLineDash([5, 4]);
    c.beginPath();
    c.moveTo(frame.left, frame.py(this.line));
    c.lineTo(frame.wide - frame.right, frame.py(this.line));
    c.stroke();
    c.setLineDash([]);
  }
}
