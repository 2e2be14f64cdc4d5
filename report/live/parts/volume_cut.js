// A volume cut by a plane that is moved through it, in the colours of a number.

import { showTriad } from "./triad.js";
import { View3D } from "./view3d.js";
import { bytes, colour, scaleColours } from "./theme.js";

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
      isFlat: true });
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

  /** Values on the plane, rows by columns; place: reading along `axis`, between those of the grid. */
  cut(values, axis, place) {
    const { at } = this, [a, b] = [0, 1, 2].filter(k => k !== axis), along = at[axis];
    let i = 0;
    while (i < along.length - 2 && along[i + 1] < place) i++;
    const share = Math.max(0, Math.min(1, (place - along[i]) / (along[i + 1] - along[i])));
    const [n1, n2] = [at[1].length, at[2].length], index = [0, 0, 0];
    const value = (u, v, w) => {
      [index[axis], index[a], index[b]] = [w, u, v];
      return values[(index[0] * n1 + index[1]) * n2 + index[2]];
    };
    return { axis, a, b, place, values: at[a].map((_, u) => at[b].map(
      (_, v) => (1 - share) * value(u, v, i) + share * value(u, v, i + 1))) };
  }

  /** Draws a plane; most: value of the last colour. */
  show(plane, most) {
    const { a, b, axis, place, values } = plane, corners = [], numbers = [];
    const put = (u, v) => {
      const point = [0, 0, 0];
      [point[axis], point[a], point[b]] = [place, this.at[a][u], this.at[b][v]];
      corners.push(...point);
      numbers.push(values[u][v]);
    };
    for (let u = 0; u + 1 < this.at[a].length; u++) {
      for (let v = 0; v + 1 < this.at[b].length; v++) {
        for (const [i, j] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) put(u + i, v + j);
      }
    }
    const none = bytes(colour("line"));
    const colours = scaleColours(numbers.map(v => (Number.isFinite(v) ? v : 0)), 0, most);
    numbers.forEach((v, i) => { if (!Number.isFinite(v)) colours.set(none, 3 * i); });
    this.plane.set("corners", Float32Array.from(corners));
    this.plane.set("colours", colours);
  }
}
