// A camera that goes round a point: turn, tilt, distance; by pointer, wheel and keys.

const NEAREST = 1e-3;
const FILLED = 0.88;  // of the picture, by what is looked at

export class OrbitCamera {
  /** turn and tilt in rad, Z up; far in the unit of the scene; at: the point that is looked at. */
  constructor({ turn = -0.9, tilt = 0.4, far = 950, at = [0, 0, 0] } = {}) {
    this.start = { turn, tilt, far, at: [...at] };
    this.size = far;  // diagonal of what is looked at
    this.reset();
  }

  reset() {
    const { turn, tilt, far, at } = this.start;
    Object.assign(this, { turn, tilt, far, at: [...at] });
  }

  /** Looks at points (three numbers each) so that they fill a picture of a shape. */
  fit(points, aspect) {
    const low = [Infinity, Infinity, Infinity], high = low.map(v => -v);
    points.forEach((v, i) => {
      low[i % 3] = Math.min(low[i % 3], v);
      high[i % 3] = Math.max(high[i % 3], v);
    });
    this.size = Math.hypot(...high.map((v, k) => v - low[k])) || 1;
    this.start.at = low.map((v, k) => (v + high[k]) / 2);
    this.start.far = this.size;
    this.points = points;
    this.reset();
    this.refit(aspect);
  }

  /** Fills a picture of another shape, unless it was turned or moved since. */
  refit(aspect) {
    const { start } = this, isMoved = ["turn", "tilt", "far"].some(k => this[k] !== start[k])
      || start.at.some((v, k) => v !== this.at[k]);
    if (!this.points || isMoved || aspect === this.aspect) return;
    this.aspect = aspect;
    for (let pass = 0; pass < 3; pass++) {  // what is nearer looks larger: the middle moves
      const { far, middle } = this.filling(aspect), { right, up } = this.axes();
      start.far = far || this.size;
      start.at = start.at.map((v, k) => v + middle[0] * right[k] + middle[1] * up[k]);
      this.reset();
    }
  }

  /** Distance from which the points fill a picture, and their middle to the right and above. */
  filling(aspect) {
    const { right, up, out } = this.axes(), f = this.focus(aspect) / FILLED, { points, at } = this;
    const along = (a, i) => a[0] * (points[i] - at[0]) + a[1] * (points[i + 1] - at[1])
      + a[2] * (points[i + 2] - at[2]);
    let far = 0;
    const ends = [Infinity, -Infinity, Infinity, -Infinity];
    for (let i = 0; i < points.length; i += 3) {
      const [x, y, z] = [right, up, out].map(a => along(a, i));
      far = Math.max(far, z + Math.abs(x) * f / aspect, z + Math.abs(y) * f);
      [ends[0], ends[1]] = [Math.min(ends[0], x), Math.max(ends[1], x)];
      [ends[2], ends[3]] = [Math.min(ends[2], y), Math.max(ends[3], y)];
    }
    return { far, middle: [(ends[0] + ends[1]) / 2, (ends[2] + ends[3]) / 2] };
  }

  /** Height of a picture at distance 1, as a factor. */
  focus(aspect) {
    return 2.2 * Math.min(1, aspect / 1.1);
  }

  /** Unit vectors to the right, up and towards the eye. */
  axes() {
    const [ct, st] = [Math.cos(this.turn), Math.sin(this.turn)];
    const [cl, sl] = [Math.cos(this.tilt), Math.sin(this.tilt)];
    return { right: [-st, ct, 0], up: [-sl * ct, -sl * st, cl], out: [cl * ct, cl * st, sl] };
  }

  /** Direction of the light: over the shoulder. */
  sun() {
    return [0.6 * Math.cos(this.turn + 0.5), 0.6 * Math.sin(this.turn + 0.5), 0.8];
  }

  /** Depths between which things are drawn. */
  range() {
    return [this.far / 50, this.far + 4 * this.size];
  }

  /** Moves depths in clip space, over w, towards the eye: marks stand before their faces. */
  lift() {
    const [near, far] = this.range();
    return 0.004 * this.size * 2 * near * far / (far - near);
  }

  /** Columns of the 4 x 4 matrix from the scene to clip space. */
  matrix(aspect) {
    const { right, up, out } = this.axes(), f = this.focus(aspect);
    const [near, far] = this.range();
    const dot = v => v[0] * this.at[0] + v[1] * this.at[1] + v[2] * this.at[2];
    const m = new Float32Array(16), A = (near + far) / (near - far), away = dot(out) + this.far;
    for (let k = 0; k < 3; k++) {
      m[4 * k] = f / aspect * right[k];
      m[4 * k + 1] = f * up[k];
      m[4 * k + 2] = A * out[k];
      m[4 * k + 3] = -out[k];
    }
    m[12] = -f / aspect * dot(right);
    m[13] = -f * dot(up);
    m[14] = 2 * near * far / (near - far) - A * away;
    m[15] = away;
    return m;
  }

  orbit(dx, dy) {
    this.turn -= 0.008 * dx;
    this.tilt = Math.max(-1.55, Math.min(1.55, this.tilt + 0.008 * dy));
  }

  /** Moves the point that is looked at; dx, dy in shares of the height of the picture. */
  pan(dx, dy) {
    const { right, up } = this.axes(), s = this.far / 1.1;
    for (let k = 0; k < 3; k++) this.at[k] += s * (dy * up[k] - dx * right[k]);
  }

  zoom(factor) {
    const most = 8 * this.start.far;
    this.far = Math.max(NEAREST * this.start.far, Math.min(most, this.far * factor));
  }

  /** Drag: turn; shift or second button and drag: move; wheel or pinch: nearer; keys as named. */
  attach(canvas, changed) {
    const held = new Map();
    let apart = 0;
    const spread = () => {
      const [a, b] = [...held.values()];
      return Math.hypot(a[0] - b[0], a[1] - b[1]);
    };
    canvas.addEventListener("pointerdown", e => {
      held.set(e.pointerId, [e.clientX, e.clientY]);
      canvas.setPointerCapture(e.pointerId);
      if (held.size === 2) apart = spread();
    });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, e => held.delete(e.pointerId));
    }
    canvas.addEventListener("contextmenu", e => e.preventDefault());
    canvas.addEventListener("pointermove", e => {
      const before = held.get(e.pointerId);
      if (!before) return;
      const [dx, dy] = [e.clientX - before[0], e.clientY - before[1]];
      held.set(e.pointerId, [e.clientX, e.clientY]);
      if (held.size === 2) {
        const now = spread();
        if (now > 0 && apart > 0) this.zoom(apart / now);
        apart = now;
      } else if (e.shiftKey || e.buttons & 6) {
        this.pan(dx / canvas.clientHeight, dy / canvas.clientHeight);
      } else this.orbit(dx, dy);
      changed();
    });
    canvas.addEventListener("wheel", e => {
      e.preventDefault();
      this.zoom(Math.exp(0.001 * e.deltaY));
      changed();
    }, { passive: false });
    canvas.addEventListener("keydown", e => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      if (way[e.key]) {
        const [x, y] = way[e.key];
        if (e.shiftKey) this.pan(-0.05 * x, -0.05 * y); else this.orbit(12 * x, 12 * y);
      } else if (e.key === "+" || e.key === "=") this.zoom(0.85);
      else if (e.key === "-") this.zoom(1 / 0.85);
      else if (e.key === "0" || e.key === "Home") this.reset();
      else return;
      e.preventDefault();
      changed();
    });
  }
}
