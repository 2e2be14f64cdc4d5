// A machine in three dimensions: its bodies, letters, tool points and paths.

import { View3D, rgb } from "./view3d.js";
import { bodyPoses, placed, product } from "./kinematics.js";
import { bytes, colour } from "./theme.js";
import { element } from "./elements.js";

// with a level spindle Y stands upright; the camera has Z upright
const UPRIGHT = {
  z: Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1),
  y: Float64Array.of(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1),
};
const NEAR = 700;  // mm round a path: table and spindle are seen with it
const TOUCHING = [0.84, 0.2, 0.1];

function repeated(hex, count) {
  const one = bytes(hex), out = new Uint8Array(3 * count);
  for (let i = 0; i < out.length; i++) out[i] = one[i % 3];
  return out;
}

/** Segments of a line through points of three numbers each. */
function segments(points) {
  const out = new Float32Array(Math.max(0, 2 * points.length - 6));
  for (let i = 0; i + 3 < points.length; i += 3) {
    for (let k = 0; k < 6; k++) out[2 * i + k] = points[i + k];
  }
  return out;
}

export class MachineView {
  /** overlay: element over the canvas that takes the letters of the axes. */
  constructor(canvas, overlay, data) {
    Object.assign(this, { data, machine: data.machine, world: UPRIGHT[data.up] });
    this.view = new View3D(canvas, { camera: {
      turn: data.up === "y" ? 0.6 : -1.1, tilt: 0.42 } });
    this.bodies = data.bodies.map(body => ({
      on: body.on,
      layer: this.view.mesh({ corners: body.corners.values, colour: rgb(body.colour) }),
      colour: rgb(body.colour),
    }));
    this.letters = data.letters.map(letter => ({
      ...letter, mark: overlay.appendChild(element("span", { text: letter.text })),
    }));
    const none = new Float32Array(0), dots = new Uint8Array(0);
    this.paths = ["nominal", "actual"].map(
      () => this.view.lines({ positions: none, colours: dots, size: 1.5 }));
    this.arrow = this.view.lines({ positions: new Float32Array(6), colours: new Uint8Array(3),
      size: 3 });
    this.tips = this.view.points({ positions: new Float32Array(6), colours: new Uint8Array(6),
      size: 11, isPickable: false });
    this.view.afterDraw = () => this.placeLetters();
    this.recolour();
  }

  /** Colours of the theme. */
  recolour() {
    this.view.ground = colour("ground");
    const both = new Uint8Array([...bytes(colour("held")), ...bytes(colour("bad"))]);
    this.tips.set("colours", both);
    this.arrow.set("colours", both.slice(3));
    this.paths.forEach((path, k) => {
      const count = path.positions.length / 6;
      path.set("colours", repeated(colour(k ? "bad" : "held"), count));
    });
  }

  /** Paths of the tool point in the table frame, three numbers a point. */
  showPaths(nominal, actual) {
    [nominal, actual].forEach((points, k) => {
      const positions = segments(points);
      this.paths[k].set("positions", positions);
      this.paths[k].set("colours", repeated(colour(k ? "bad" : "held"), positions.length / 6));
    });
  }

  /**
   * A pose. nominal, actual: tool points in the table frame, the second as far off as it is shown;
   * errors: with which bodies are drawn, or null; isTouching: whether the probe is at a surface.
   */
  show({ q, nominal, actual, errors, isTouching = false }) {
    const { machine, world } = this, poses = bodyPoses(machine, q, errors);
    this.shown = Object.fromEntries(
      Object.entries(poses).map(([name, T]) => [name, product(world, T)]));
    for (const { on, layer, colour: own } of this.bodies) {
      layer.place = Float32Array.from(this.shown[on]);
      layer.colour = isTouching && on === "t" ? TOUCHING : own;
    }
    const [x, y, z] = machine.origin, table = Float64Array.of(
      1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1);
    this.table = Float32Array.from(product(this.shown.w, table));
    for (const layer of [...this.paths, this.arrow, this.tips]) layer.place = this.table;
    this.tips.set("positions", Float32Array.of(...nominal, ...actual));
    this.arrow.set("positions", Float32Array.of(...nominal, ...actual));
    this.view.request();
  }

  /** Looks at the whole machine, or at a path in the table frame with room around it. */
  look(path) {
    const { camera } = this.view;
    this.view.fit();
    if (path.length) {
      camera.points = null;  // the path alone decides
      const low = [Infinity, Infinity, Infinity], high = low.map(v => -v);
      for (let i = 0; i < path.length; i += 3) {
        placed(this.table, path.slice(i, i + 3)).forEach((v, k) => {
          low[k] = Math.min(low[k], v);
          high[k] = Math.max(high[k], v);
        });
      }
      const size = Math.hypot(...high.map((v, k) => v - low[k]));
      camera.start.at = low.map((v, k) => (v + high[k]) / 2);
      camera.start.far = Math.min(camera.start.far, 2 * size + NEAR);
    }
    camera.reset();
    this.view.request();
  }

  hideFoundation(isHidden) {
    for (const { on, layer } of this.bodies) if (on === "f") layer.isVisible = !isHidden;
    this.view.request();
  }

  placeLetters() {
    if (!this.shown) return;
    for (const { on, place, mark } of this.letters) {
      const [x, y] = this.view.project(placed(this.shown[on], place));
      mark.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
    }
  }
}
