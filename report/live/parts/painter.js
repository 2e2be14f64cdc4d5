// The same view without WebGL: drawn on a plain canvas, the farthest first.

import { normalsOf } from "./normals.js";

const MOST = 30000;  // triangles that a plain canvas paints in time; the others are left out

function byte(values) {
  return `rgb(${values.map(v => Math.round(Math.max(0, Math.min(255, v)))).join(",")})`;
}

export class Painter {
  constructor(context) {
    this.context = context;
  }

  forget() {}

  draw(layers, camera, ground, ratio) {
    const { context } = this, { width, height } = context.canvas;
    context.fillStyle = byte(ground.map(v => 255 * v));
    context.fillRect(0, 0, width, height);
    const things = this.things(layers, camera, width, height);
    things.sort((a, b) => b.depth - a.depth);
    this.drawn = things.filter(t => t.layer.kind !== "mesh");
    for (const thing of things) this.paint(thing, ratio);
    context.globalAlpha = 1;
  }

  things(layers, camera, width, height) {
    const eye = camera.matrix(width / height), sun = camera.sun(), out = [];
    const total = layers.reduce((n, l) => n + (l.corners ? l.corners.length / 9 : 0), 0);
    const every = Math.max(1, Math.ceil(total / MOST));
    for (const layer of layers) {
      const seen = this.projector(eye, layer.place, width, height);
      if (layer.kind === "mesh") this.triangles(out, layer, seen, sun, every);
      else this.marks(out, layer, seen, 0.08 * camera.size);
    }
    return out;
  }

  projector(eye, place, width, height) {
    const m = new Float64Array(16);
    for (let c = 0; c < 4; c++) {
      for (let r = 0; r < 4; r++) {
        for (let k = 0; k < 4; k++) m[4 * c + r] += eye[4 * k + r] * place[4 * c + k];
      }
    }
    return (v, i) => {
      const [x, y, z] = [v[i], v[i + 1], v[i + 2]];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      const a = (m[0] * x + m[4] * y + m[8] * z + m[12]) / w;
      const b = (m[1] * x + m[5] * y + m[9] * z + m[13]) / w;
      return [0.5 * width * (1 + a), 0.5 * height * (1 - b), w];
    };
  }

  triangles(out, layer, seen, sun, every) {
    const { corners } = layer, normals = normalsOf(corners), m = layer.place;
    for (let i = 0; i < corners.length; i += 9 * every) {
      const at = [seen(corners, i), seen(corners, i + 3), seen(corners, i + 6)];
      if (at.some(p => p[2] <= 0)) continue;
      const n = [0, 1, 2].map(
        r => m[r] * normals[i] + m[4 + r] * normals[i + 1] + m[8 + r] * normals[i + 2]);
      const dot = n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2];
      const lit = layer.isFlat ? 1 : 0.55 + 0.45 * Math.abs(dot);
      const base = layer.colours
        ? [0, 1, 2].map(k => layer.colours[i / 3 * 3 + k]) : layer.colour.map(v => 255 * v);
      const depth = (at[0][2] + at[1][2] + at[2][2]) / 3;
      out.push({ layer, at, depth, colour: byte(base.map(v => v * lit)) });
    }
  }

  marks(out, layer, seen, before) {
    const step = layer.kind === "points" ? 3 : 6;
    for (let k = 0; k < layer.count; k++) {
      const at = [seen(layer.positions, step * k)];
      if (step === 6) at.push(seen(layer.positions, step * k + 3));
      if (at.some(p => p[2] <= 0)) continue;
      const depth = at[0][2] - before;  // not behind the large triangle that they lie on
      const colour = byte([0, 1, 2].map(c => layer.colours[3 * k + c]));
      out.push({ layer, at, depth, colour, code: layer.first + k });
    }
  }

  paint({ layer, at, colour }, ratio) {
    const { context } = this;
    context.globalAlpha = layer.opacity;
    context.fillStyle = context.strokeStyle = colour;
    context.beginPath();
    if (layer.kind === "points") {
      context.arc(at[0][0], at[0][1], 0.5 * layer.size * ratio, 0, 2 * Math.PI);
      context.fill();
      return;
    }
    context.lineWidth = layer.kind === "mesh" ? 0.6 : layer.size * ratio;
    at.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
    if (layer.kind === "mesh") context.fill();
    context.stroke();
  }

  /** Number of the nearest mark within a few pixels; bodies are not picked here. */
  pick(layers, camera, x, y, ratio) {
    let best = 0, least = 6 * ratio;
    for (const { layer, at, code } of this.drawn || []) {
      if (!layer.isPickable || layer.kind !== "points") continue;
      const away = Math.hypot(at[0][0] - x, at[0][1] - y);
      if (away <= least) [best, least] = [code, away];
    }
    return best;
  }
}
