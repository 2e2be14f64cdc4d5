// A volume cut by a plane that is moved through it: lengths of vectors as colours, and arrows.

import { showTriad } from "./triad.js";
import { View3D } from "./view3d.js";
import { bytes, colour, scaleColours } from "./theme.js";

const LONGEST = 0.11;  // arrow of the last colour, over the diagonal of the box, at a stretch of 1

/** The eight corners of a box joined by its edges, six numbers an edge. */
function edges(at) {
  const ends = at.map(a => [a[0], a[a.length - 1]]), out = [];
  for (let k = 0; k < 3; k++) {
    const [a, b] = [0, 1, 2].filter(i => i !== k);
    for (const u of ends[a]) {
      for (const v of ends[b]) {
        for (const w of ends[k]) {
          const point = [0, 0, 0];
          [point[k], point[a], point[b]] = [w, u, v];
          out.push(...point);
        }
      }
    }
  }
  return new Float32Array(out);
}

export class VolumeCut {
  /** at: places along each of three axes, ascending; names: of the axes. */
  constructor(canvas, at, names) {
    Object.assign(this, { at });
    this.view = new View3D(canvas, { camera: { turn: -1.0, tilt: 0.45 } });
    const positions = edges(at);
    this.box = this.view.lines({ positions, colours: new Uint8Array(positions.length / 2) });
    this.plane = this.view.mesh({ corners: positions.slice(0, 9), colours: new Uint8Array(9),
      isFlat: true, opacity: 0.8 });
    this.arrows = this.view.lines({ positions: new Float32Array(0), colours: new Uint8Array(0),
      size: 2 });
    this.feet = this.view.points({ positions: new Float32Array(0), colours: new Uint8Array(0),
      size: 4, isPickable: false });
    this.view.fit();
    showTriad(this.view, names);
    this.recolour();
  }

  recolour() {
    this.view.ground = colour("ground");
    const one = bytes(colour("soft")), out = new Uint8Array(this.box.positions.length / 2);
    for (let i = 0; i < out.length; i++) out[i] = one[i % 3];
    this.box.set("colours", out);
  }

  /** Vectors on the plane, rows by columns; place: along `axis`, between those of the grid. */
  cut(values, axis, place) {
    const { at } = this, [a, b] = [0, 1, 2].filter(k => k !== axis), along = at[axis];
    let i = 0;
    while (i < along.length - 2 && along[i + 1] < place) i++;
    const share = Math.max(0, Math.min(1, (place - along[i]) / (along[i + 1] - along[i])));
    const [n1, n2] = [at[1].length, at[2].length], index = [0, 0, 0];
    const value = (u, v, w, k) => {
      [index[axis], index[a], index[b]] = [w, u, v];
      return values[3 * ((index[0] * n1 + index[1]) * n2 + index[2]) + k];
    };
    return { axis, a, b, place, vectors: at[a].map((_, u) => at[b].map((_, v) => [0, 1, 2].map(
      k => (1 - share) * value(u, v, i, k) + share * value(u, v, i + 1, k)))) };
  }

  /** Draws a plane; most: length of the last colour; stretch: of the arrows. */
  show(plane, most, stretch) {
    const { a, b, axis, place, vectors } = plane, { at } = this, corners = [], lengths = [];
    const pointAt = (u, v) => {
      const point = [0, 0, 0];
      [point[axis], point[a], point[b]] = [place, at[a][u], at[b][v]];
      return point;
    };
    const put = (u, v) => {
      corners.push(...pointAt(u, v));
      lengths.push(Math.hypot(...vectors[u][v]));
    };
    for (let u = 0; u + 1 < at[a].length; u++) {
      for (let v = 0; v + 1 < at[b].length; v++) {
        for (const [i, j] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) put(u + i, v + j);
      }
    }
    const none = bytes(colour("line"));
    const colours = scaleColours(lengths.map(v => (Number.isFinite(v) ? v : 0)), 0, most);
    lengths.forEach((v, i) => { if (!Number.isFinite(v)) colours.set(none, 3 * i); });
    this.plane.set("corners", Float32Array.from(corners));
    this.plane.set("colours", colours);
    this.showArrows(vectors, pointAt, stretch / most);
  }

  showArrows(vectors, pointAt, factor) {
    const unit = LONGEST * this.view.camera.size * factor, arrows = [], feet = [];
    vectors.forEach((row, u) => row.forEach((vector, v) => {
      if (!vector.every(Number.isFinite)) return;
      const from = pointAt(u, v);
      feet.push(...from);
      arrows.push(...from, ...from.map((x, k) => x + unit * vector[k]));
    }));
    const ink = bytes(colour("ink")), colours = Uint8Array.from(feet, (_, i) => ink[i % 3]);
    for (const [layer, positions] of [[this.arrows, arrows], [this.feet, feet]]) {
      layer.positions = Float32Array.from(positions);
      layer.set("positions", layer.positions);
      layer.set("colours", colours);
    }
  }
}
