// Lines over a number: curves that share their axes, with a mark that the pointer can move.

import { colour } from "./theme.js";
import { Frame } from "./frame.js";
import { padded } from "./scatter.js";

export class Curves {
  /** picked(x): the number under the pointer where it is pressed. */
  constructor(canvas, { picked = null, ...frame } = {}) {
    this.frame = new Frame(canvas, frame);
    Object.assign(this, { canvas, curves: [], at: null });
    if (picked) {
      const pick = e => e.buttons & 1 && picked(this.frame.vx(e.offsetX));
      canvas.addEventListener("pointerdown", pick);
      canvas.addEventListener("pointermove", pick);
    }
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** curves: [{ x, y, colour, width, dash }]; at: number of the upright mark, or null. */
  show({ curves = this.curves, xRange, yRange, at = this.at }) {
    Object.assign(this, { curves, at });
    if (xRange) this.frame.x = padded(xRange);
    if (yRange) this.frame.y = padded(yRange);
    this.draw();
  }

  draw() {
    const { frame } = this, c = frame.context;
    if (!frame.begin()) return;
    frame.axes();
    for (const curve of this.curves) {
      c.strokeStyle = curve.colour;
      c.lineWidth = curve.width || 1.5;
      c.setLineDash(curve.dash || []);
      c.beginPath();
      let isDown = false;
      for (let i = 0; i < curve.x.length; i++) {
        const isHere = Number.isFinite(curve.y[i]);
        if (isHere && isDown) c.lineTo(frame.px(curve.x[i]), frame.py(curve.y[i]));
        else if (isHere) c.moveTo(frame.px(curve.x[i]), frame.py(curve.y[i]));
        isDown = isHere;
      }
      c.stroke();
    }
    c.setLineDash([]);
    if (this.at === null) return;
    c.strokeStyle = colour("mark");
    c.lineWidth = 1.5;
    c.beginPath();
    c.moveTo(frame.px(this.at), frame.top);
    c.lineTo(frame.px(this.at), frame.high - frame.bottom);
    c.stroke();
  }
}
