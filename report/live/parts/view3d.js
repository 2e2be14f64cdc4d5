// A view in three dimensions: triangles, points and lines, with picking; WebGL 2, or drawn without.

import { OrbitCamera } from "./camera.js";
import { Painter } from "./painter.js";
import { GlDrawer } from "./gl_drawer.js";

// Directions in which the ends of a scene are looked for: to corners, edges and faces of a cube.
const WAYS = [-1, 0, 1].flatMap(x => [-1, 0, 1].flatMap(y => [-1, 0, 1].map(z => [x, y, z])))
  .filter(way => way.some(v => v));
const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

/** "#rrggbb" as three shares of 1. */
export function rgb(hex) {
  return [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16) / 255);
}

/** What is drawn in one call. Change its fields and call `view.request()`. */
class Layer {
  constructor(view, kind, fields) {
    const always = { isVisible: true, isPickable: false, place: IDENTITY, opacity: 1, size: 1 };
    Object.assign(this, always, fields, { view, kind, changed: new Set(), first: 0, buffers: {} });
  }

  /** Replaces an array: `positions`, `corners`, `colours` ... */
  set(name, values) {
    this[name] = values;
    this.changed.add(name);
    this.view.request();
  }

  /** Number of things that can be picked one by one. */
  get count() {
    if (this.kind === "mesh") return 1;
    return this.positions.length / (this.kind === "points" ? 3 : 6);
  }
}

export class View3D {
  /**
   * @param canvas Element; it is given a tab stop and keys.
   * @param options camera: options of OrbitCamera; ground: colour behind, "#rrggbb";
   *   isSmooth: false for edges in steps, which a renderer without a graphics card draws in half of
   *   the time; isDrawn: true to do without WebGL (for tests and for machines that have none).
   */
  constructor(canvas, { camera = {}, ground = "#ffffff", isSmooth = true, isDrawn = false } = {}) {
    this.canvas = canvas;
    this.layers = [];
    this.ground = ground;
    this.camera = new OrbitCamera(camera);
    this.afterDraw = () => {};
    this.isWaiting = false;
    const wanted = { antialias: isSmooth, preserveDrawingBuffer: true };
    const gl = isDrawn ? null : canvas.getContext("webgl2", wanted);
    this.drawer = gl ? new GlDrawer(gl) : new Painter(canvas.getContext("2d"));
    this.isGl = Boolean(gl);
    canvas.tabIndex = 0;
    canvas.style.touchAction = "none";
    this.camera.attach(canvas, () => this.request());
    canvas.addEventListener("webglcontextlost", e => e.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.drawer = new GlDrawer(gl);
      for (const layer of this.layers) layer.buffers = {};
      this.request();
    });
    new ResizeObserver(() => this.request()).observe(canvas);
  }

  add(kind, fields) {
    const layer = new Layer(this, kind, fields);
    this.layers.push(layer);
    let first = 1;  // numbers of what can be picked; 0 is nothing
    for (const one of this.layers) {
      one.first = first;
      first += one.count;
    }
    this.request();
    return layer;
  }

  /**
   * Triangles. corners: Float32Array, nine numbers each; colour: [r, g, b] of 1, or colours: three
   * bytes for each corner; place: columns of the 4 x 4 matrix that moves them; isFlat: unshaded.
   */
  mesh(fields) {
    return this.add("mesh", { colour: [0.7, 0.7, 0.7], ...fields });
  }

  /** Discs that face the eye. positions: three numbers each; colours: three bytes; size in pixels. */
  points(fields) {
    return this.add("points", { size: 7, isPickable: true, ...fields });
  }

  /** Segments. positions: six numbers each; colours: three bytes each; size: width in pixels. */
  lines(fields) {
    return this.add("lines", { size: 1.5, ...fields });
  }

  remove(layer) {
    this.layers = this.layers.filter(one => one !== layer);
    this.drawer.forget(layer);
    this.request();
  }

  /** Looks at all that is there: the ends of every layer in some directions decide. */
  fit() {
    const points = [];
    for (const layer of this.layers) {
      const values = layer.corners || layer.positions, m = layer.place;
      for (const i of values.length ? ends(values) : []) {
        for (let k = 0; k < 3; k++) {
          points.push(m[k] * values[i] + m[4 + k] * values[i + 1] + m[8 + k] * values[i + 2]
            + m[12 + k]);
        }
      }
    }
    if (points.length) this.camera.fit(points, this.aspect);
    this.request();
  }

  /** Width over height. */
  get aspect() {
    return this.canvas.clientWidth / this.canvas.clientHeight || 1.3;
  }

  /** Draws before the next frame; many calls draw once. */
  request() {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.draw();
    });
  }

  get shown() {
    return this.layers.filter(layer => layer.isVisible && layer.count);
  }

  /** Size of the picture in its own pixels; false while the element has none. */
  resize() {
    const { canvas } = this, ratio = window.devicePixelRatio || 1;
    const wide = Math.round(canvas.clientWidth * ratio);
    const high = Math.round(canvas.clientHeight * ratio);
    if (!wide || !high) return false;
    if (canvas.width !== wide || canvas.height !== high) {
      canvas.width = wide;
      canvas.height = high;
    }
    return true;
  }

  draw() {
    if (!this.resize()) return;
    this.camera.refit(this.aspect);
    this.drawer.draw(this.shown, this.camera, rgb(this.ground), window.devicePixelRatio || 1);
    this.afterDraw();
  }

  /** What is seen at a point of the element, CSS pixels: { layer, index }, or null. */
  pick(x, y) {
    if (!this.resize()) return null;
    const ratio = window.devicePixelRatio || 1;
    const code = this.drawer.pick(this.shown, this.camera, x * ratio, y * ratio, ratio);
    if (!code) return null;
    const layer = this.layers.find(one => code >= one.first && code < one.first + one.count);
    return layer && layer.isPickable ? { layer, index: code - layer.first } : null;
  }

  /** Where a point of the scene is seen, CSS pixels: [x, y]. */
  project(point) {
    const { canvas } = this, m = this.camera.matrix(this.aspect);
    const clip = [0, 1, 3].map(
      r => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r]);
    const x = 0.5 * canvas.clientWidth * (1 + clip[0] / clip[2]);
    return [x, 0.5 * canvas.clientHeight * (1 - clip[1] / clip[2])];
  }
}

/** Where the points begin that lie farthest in each direction, every one once. */
function ends(values) {
  const far = new Float64Array(WAYS.length).fill(-Infinity), at = new Int32Array(WAYS.length);
  for (let i = 0; i < values.length; i += 3) {
    for (let k = 0; k < WAYS.length; k++) {
      const [x, y, z] = WAYS[k], reach = x * values[i] + y * values[i + 1] + z * values[i + 2];
      if (reach > far[k]) [far[k], at[k]] = [reach, i];
    }
  }
  return new Set(at);
}
