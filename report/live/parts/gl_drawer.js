// Drawing with WebGL 2: one program for each kind of layer; picking by a pass of numbers as colours.

import { normalsOf } from "./normals.js";

const CODE = `
vec3 code(uint n) {
  return vec3(float(n & 255u), float((n >> 8) & 255u), float((n >> 16) & 255u)) / 255.0;
}`;

const MESH = [`#version 300 es
in vec3 p; in vec3 n; in vec3 c;
uniform mat4 place, eye; out vec3 turned, tint;
void main() {
  turned = mat3(place) * n; tint = c; gl_Position = eye * (place * vec4(p, 1.0));
}`, `#version 300 es
precision highp float; in vec3 turned, tint; out vec4 seen;
uniform vec3 colour, sun; uniform float shade, opacity, mixed; uniform highp uint first;${CODE}
void main() {
  if (first > 0u) { seen = vec4(code(first), 1.0); return; }
  float lit = mix(1.0, 0.55 + 0.45 * abs(dot(normalize(turned), sun)), shade);
  seen = vec4(mix(colour, tint, mixed) * lit, opacity);
}`];

const POINTS = [`#version 300 es
in vec3 p; in vec3 c;
uniform mat4 place, eye; uniform float size, lift; uniform highp uint first; out vec3 tint;${CODE}
void main() {
  gl_Position = eye * (place * vec4(p, 1.0));
  gl_Position.z -= lift / gl_Position.w;  // before the face that they lie on
  gl_PointSize = size; tint = first > 0u ? code(first + uint(gl_VertexID)) : c;
}`, `#version 300 es
precision highp float; in vec3 tint; out vec4 seen; uniform float opacity; uniform highp uint first;
void main() {
  float away = length(gl_PointCoord - 0.5);
  if (away > 0.5) discard;
  if (first > 0u) { seen = vec4(tint, 1.0); return; }
  seen = vec4(away > 0.4 ? 0.7 * tint : tint, opacity);
}`];

const LINES = [`#version 300 es
in vec2 corner; in vec3 a; in vec3 b; in vec3 c;
uniform mat4 place, eye; uniform vec2 screen; uniform float size, lift; uniform highp uint first;
out vec3 tint;${CODE}
void main() {
  vec4 from = eye * (place * vec4(a, 1.0)), to = eye * (place * vec4(b, 1.0));
  vec4 here = corner.x < 0.5 ? from : to;
  vec2 way = (to.xy / to.w - from.xy / from.w) * screen;
  float size2d = length(way);
  vec2 across = size2d > 0.0 ? vec2(-way.y, way.x) / size2d : vec2(0.0);
  here.xy += across * corner.y * size / screen * here.w;
  here.z -= lift / here.w;
  gl_Position = here; tint = first > 0u ? code(first + uint(gl_InstanceID)) : c;
}`, `#version 300 es
precision highp float; in vec3 tint; out vec4 seen; uniform float opacity; uniform highp uint first;
void main() { seen = vec4(tint, first > 0u ? 1.0 : opacity); }`];

const THIN = [POINTS[0], LINES[1]];
const MANY = 3000;  // segments from which they are one pixel wide: a renderer without a graphics card
// takes 20 times longer for a strip each

const NAMES = ["place", "eye", "colour", "sun", "shade", "opacity", "mixed", "first", "size",
  "screen", "lift"];

function built(gl, [vertex, fragment]) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(gl.getShaderInfoLog(shader));
    }
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(gl.getProgramInfoLog(program));
  }
  const uniforms = Object.fromEntries(NAMES.map(n => [n, gl.getUniformLocation(program, n)]));
  return { program, uniforms, at: name => gl.getAttribLocation(program, name) };
}

export class GlDrawer {
  constructor(gl) {
    this.gl = gl;
    this.programs = { mesh: built(gl, MESH), points: built(gl, POINTS), lines: built(gl, LINES),
      thin: built(gl, THIN) };
    this.quad = this.buffer(new Float32Array([0, -1, 1, -1, 0, 1, 1, 1]));
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  buffer(values) {
    const { gl } = this, made = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    return made;
  }

  forget(layer) {
    for (const buffer of Object.values(layer.buffers)) this.gl.deleteBuffer(buffer);
    layer.buffers = {};
  }

  /** The buffer of an array of a layer, sent again when it has changed. */
  sent(layer, name, values) {
    if (!layer.buffers[name]) layer.buffers[name] = this.buffer(values());
    else if (layer.changed.has(name)) {
      this.gl.bindBuffer(this.gl.ARRAY_BUFFER, layer.buffers[name]);
      this.gl.bufferData(this.gl.ARRAY_BUFFER, values(), this.gl.DYNAMIC_DRAW);
    }
    return layer.buffers[name];
  }

  attribute(place, buffer, { size = 3, type, stride = 0, offset = 0, divisor = 0 } = {}) {
    const { gl } = this;
    if (place < 0) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    const kind = type ?? gl.FLOAT;
    gl.vertexAttribPointer(place, size, kind, kind !== gl.FLOAT, stride, offset);
    gl.vertexAttribDivisor(place, divisor);
  }

  /** Opaque first, then what is seen through. */
  draw(layers, camera, ground, ratio) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.clearColor(...ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const opaque = layers.filter(one => one.opacity >= 1);
    const clear = layers.filter(one => one.opacity < 1);
    for (const layer of opaque) this.layer(layer, camera, ratio, 0);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const layer of clear) this.layer(layer, camera, ratio, 0);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  layer(layer, camera, ratio, first) {
    const { gl } = this, kind = layer.kind === "lines" && layer.count > MANY ? "thin" : layer.kind;
    const { program, uniforms, at } = this.programs[kind];
    const [wide, high] = [gl.canvas.width, gl.canvas.height];
    gl.useProgram(program);
    for (let k = 0; k < 4; k++) {
      gl.disableVertexAttribArray(k);
      gl.vertexAttribDivisor(k, 0);
    }
    gl.uniformMatrix4fv(uniforms.eye, false, camera.matrix(wide / high));
    gl.uniformMatrix4fv(uniforms.place, false, layer.place);
    gl.uniform1f(uniforms.opacity, layer.opacity);
    gl.uniform1f(uniforms.size, layer.size * ratio);
    gl.uniform1ui(uniforms.first, first);
    gl.uniform1f(uniforms.lift, camera.lift());
    this[kind](layer, { uniforms, at, camera, wide, high });
    layer.changed.clear();
  }

  mesh(layer, { uniforms, at, camera }) {
    const { gl } = this;
    gl.uniform3fv(uniforms.sun, camera.sun());
    gl.uniform3fv(uniforms.colour, layer.colour);
    gl.uniform1f(uniforms.shade, layer.isFlat ? 0 : 1);
    gl.uniform1f(uniforms.mixed, layer.colours ? 1 : 0);
    this.attribute(at("p"), this.sent(layer, "corners", () => layer.corners));
    if (layer.changed.has("corners")) layer.changed.add("normals");
    this.attribute(at("n"), this.sent(layer, "normals", () => normalsOf(layer.corners)));
    if (layer.colours) this.colours(at("c"), layer, 0);
    gl.drawArrays(gl.TRIANGLES, 0, layer.corners.length / 3);
  }

  points(layer, { at }) {
    this.attribute(at("p"), this.sent(layer, "positions", () => layer.positions));
    this.colours(at("c"), layer, 0);
    this.gl.drawArrays(this.gl.POINTS, 0, layer.count);
  }

  lines(layer, { uniforms, at, wide, high }) {
    const { gl } = this, segments = this.sent(layer, "positions", () => layer.positions);
    gl.uniform2f(uniforms.screen, wide, high);
    this.attribute(at("corner"), this.quad, { size: 2 });
    this.attribute(at("a"), segments, { stride: 24, divisor: 1 });
    this.attribute(at("b"), segments, { stride: 24, offset: 12, divisor: 1 });
    this.colours(at("c"), layer, 1);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, layer.count);
  }

  thin(layer, { at }) {
    const { gl } = this;
    this.attribute(at("p"), this.sent(layer, "positions", () => layer.positions));
    const both = this.sent(layer, "colours", () => twice(layer.colours));
    this.attribute(at("c"), both, { type: gl.UNSIGNED_BYTE });
    gl.drawArrays(gl.LINES, 0, 2 * layer.count);
  }

  colours(place, layer, divisor) {
    const buffer = this.sent(layer, "colours", () => layer.colours);
    this.attribute(place, buffer, { type: this.gl.UNSIGNED_BYTE, divisor });
  }

  /** Number of what is nearest to the eye at a pixel, or within three pixels of it; 0: nothing. */
  pick(layers, camera, x, y, ratio) {
    const { gl } = this, [wide, high] = [gl.canvas.width, gl.canvas.height];
    this.target(wide, high);
    gl.viewport(0, 0, wide, high);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const reach = Math.ceil(3 * ratio), side = 2 * reach + 1;
    const [left, low] = [Math.round(x) - reach, Math.round(high - y) - reach];
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(left, low, side, side);
    for (const layer of layers) {
      if (layer.opacity >= 1 || layer.isPickable) this.layer(layer, camera, ratio, layer.first);
    }
    gl.disable(gl.SCISSOR_TEST);
    const seen = new Uint8Array(4 * side * side);
    gl.readPixels(left, low, side, side, gl.RGBA, gl.UNSIGNED_BYTE, seen);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return nearest(seen, side, code => {
      const found = layers.find(one => code >= one.first && code < one.first + one.count);
      return found && found.isPickable ? (found.kind === "mesh" ? 2 : 1) : 0;
    });
  }

  target(wide, high) {
    const { gl } = this;
    if (!this.frame) {
      this.frame = gl.createFramebuffer();
      this.picture = gl.createRenderbuffer();
      this.depth = gl.createRenderbuffer();
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    if (this.wide === wide && this.high === high) return;
    Object.assign(this, { wide, high });
    for (const [made, format, slot] of [
      [this.picture, gl.RGBA8, gl.COLOR_ATTACHMENT0],
      [this.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT],
    ]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, made);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, wide, high);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, slot, gl.RENDERBUFFER, made);
    }
  }
}

/** The colour of each segment for both of its ends. */
function twice(colours) {
  const out = new Uint8Array(2 * colours.length);
  for (let i = 0; i < colours.length; i++) {
    const at = i + 3 * Math.floor(i / 3);
    out[at] = out[at + 3] = colours[i];
  }
  return out;
}

/** The code nearest to the middle of a square of pixels; points and lines win over bodies. */
function nearest(seen, side, rank) {
  let best = 0, least = Infinity;
  const middle = (side - 1) / 2;
  for (let i = 0; i < side * side; i++) {
    const code = seen[4 * i] + 256 * seen[4 * i + 1] + 65536 * seen[4 * i + 2];
    if (!code) continue;
    const away = Math.hypot(i % side - middle, Math.floor(i / side) - middle), kind = rank(code);
    if (!kind || (kind === 2 && away > 0.5)) continue;
    const cost = away + (kind === 2 ? 2 * side : 0);
    if (cost < least) [best, least] = [code, cost];
  }
  return best;
}
