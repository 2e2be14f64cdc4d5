// Kinematics of a machine, nominal and with errors, as `matstd.twin.machine` has them; mm and rad.
//
// A machine: { links: [{ name, kind, carries, direction, point, axis, own, frame }], origin }, links
// from workpiece to tool; axis: column of the readings, or -1. Errors: { twist, place }, six numbers
// a link (X Y Z A B C, tool side minus workpiece side), or null for the nominal machine; their
// directions are the columns of frame, of an inclined axis, or those of the machine.

const SMALL = 1e-4;  // square of an angle below which three terms of a series are exact

/** Room for the errors of a machine. */
export function noErrors(machine) {
  const size = 6 * machine.links.length;
  return { twist: new Float64Array(size), place: new Float64Array(size) };
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** A vector turned by a rotation vector (Rodrigues). */
function turned(r, v) {
  const square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
  let first, second;
  if (square < SMALL) {
    first = 1 - square * (1 / 6 - square * (1 / 120));
    second = 0.5 - square * (1 / 24 - square * (1 / 720));
  } else {
    const angle = Math.sqrt(square), half = Math.sin(angle / 2) / angle;
    first = Math.sin(angle) / angle;
    second = 2 * half * half;
  }
  const once = cross(r, v);
  const inner = [0, 1, 2].map(k => first * v[k] + second * once[k]);
  const twice = cross(r, inner);
  return [v[0] + twice[0], v[1] + twice[1], v[2] + twice[2]];
}

/** A vector turned about a unit direction. */
function about(d, angle, v) {
  const part = d[0] * v[0] + d[1] * v[1] + d[2] * v[2], c = Math.cos(angle), s = Math.sin(angle);
  const x = cross(d, v);
  return [0, 1, 2].map(k => part * d[k] + c * (v[k] - part * d[k]) + s * x[k]);
}

function add(a, b) {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

function less(a, b) {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function scaled(a, s) {
  return [a[0] * s, a[1] * s, a[2] * s];
}

function six(errors, part, i) {
  if (!errors) return null;
  const values = errors[part].subarray(6 * i, 6 * i + 6);
  return values.some(v => v !== 0) ? values : null;
}

/** Six errors of a link in directions of the machine. */
function inMachine(link, values) {
  if (!values || !link.frame) return values;
  const part = k => link.frame.map(row => row[0] * values[k] + row[1] * values[k + 1] + row[2] * values[k + 2]);
  return [...part(0), ...part(3)];
}

/** What one link does to a point that passes it. */
function stepOf(machine, i, q, errors) {
  const link = machine.links[i], travel = link.axis < 0 ? 0 : q[link.axis];
  const twist = inMachine(link, six(errors, "twist", i));
  let place = six(errors, "place", i), far = travel, along = link.direction, point = link.point;
  if (place && link.kind !== "fixed") {
    const own = (link.kind === "rotary" ? 3 : 0) + link.own;
    // about its own letter it is the zero of the reading
    const moved = inMachine(link, place.map((v, k) => link.kind === "rotary" && k === own ? 0 : v));
    far = travel + place[own];
    along = turned([moved[3], moved[4], moved[5]], along);
    point = [point[0] + moved[0], point[1] + moved[1], point[2] + moved[2]];
    place = null;
  }
  return { link, travel, far, along, point, place, twist };
}

function afterError({ link, travel, twist }, x) {
  if (!twist) return x;
  let lever = link.point;
  if (link.kind === "linear") {
    lever = add(lever, scaled(link.direction, link.carries ? -travel : travel));
  }
  const moved = turned([twist[3], twist[4], twist[5]], less(x, lever));
  return [0, 1, 2].map(k => moved[k] + (lever[k] + twist[k]));
}

function afterMotion({ link, far, along, point, place }, x) {
  if (link.kind === "linear") return add(x, scaled(along, far));
  if (link.kind === "rotary") return add(point, about(along, far, less(x, point)));
  if (!place) return x;
  const shift = [place[0], place[1], place[2]], turn = [place[3], place[4], place[5]];
  const shifted = add(point, shift);
  return link.carries
    ? add(point, turned(scaled(turn, -1), less(x, shifted)))
    : add(turned(turn, less(x, point)), shifted);
}

/** The point after a link: of the tool's side towards the foundation, of the other away from it. */
function passed(step, x) {
  return step.link.carries
    ? afterMotion(step, afterError(step, x)) : afterError(step, afterMotion(step, x));
}

/** Numbers of the links in the order in which the tool point passes them. */
function order(machine) {
  const all = machine.links.map((_, i) => i).reverse();
  return [...all.filter(i => !machine.links[i].carries), ...all.filter(i => machine.links[i].carries)];
}

/** Tool point in the table frame, exactly: [x, y, z]. */
export function toolPoint(machine, q, length, errors = null) {
  let x = [0, 0, -length];
  for (const i of order(machine)) x = passed(stepOf(machine, i, q, errors), x);
  return less(x, machine.origin);
}

/** Actual minus nominal tool point, table frame. */
export function deviationOf(machine, q, length, errors) {
  return less(toolPoint(machine, q, length, errors), toolPoint(machine, q, length));
}

/** Matrix of a rigid motion, four columns of four, from what it does to points. */
function matrixOf(move) {
  const at = move([0, 0, 0]), m = new Float64Array(16);
  for (let k = 0; k < 3; k++) m.set(less(move([0, 1, 2].map(i => Number(i === k))), at), 4 * k);
  m.set([...at, 1], 12);
  return m;
}

/** Product of two matrices of four columns. */
export function product(a, b) {
  const out = new Float64Array(16);
  for (let c = 0; c < 4; c++) {
    for (let r = 0; r < 4; r++) {
      for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    }
  }
  return out;
}

/** Inverse of a rigid motion. */
export function inverse(m) {
  const out = new Float64Array(16);
  for (let r = 0; r < 3; r++) {
    for (let c = 0; c < 3; c++) out[4 * c + r] = m[4 * r + c];
    out[12 + r] = -(m[4 * r] * m[12] + m[4 * r + 1] * m[13] + m[4 * r + 2] * m[14]);
  }
  out[15] = 1;
  return out;
}

/** A point after a matrix. */
export function placed(m, x) {
  return [0, 1, 2].map(r => m[r] * x[0] + m[4 + r] * x[1] + m[8 + r] * x[2] + m[12 + r]);
}

/**
 * Where every body is: matrices, by name of the link, from the machine's frame with every axis at
 * zero, in which bodies are drawn, to the machine's frame. `f` stays.
 */
export function bodyPoses(machine, q, errors = null) {
  const still = matrixOf(x => x), out = { f: still };
  let before = { tool: still, workpiece: still };
  const { links } = machine;
  for (let i = 0; i < links.length; i++) {  // the tool's side, from the foundation outwards
    if (links[i].carries) continue;
    const step = stepOf(machine, i, q, errors);
    before.tool = product(before.tool, matrixOf(x => passed(step, x)));
    out[links[i].name] = before.tool;
  }
  for (let i = links.length - 1; i >= 0; i--) {
    if (!links[i].carries) continue;
    const step = stepOf(machine, i, q, errors);
    before.workpiece = product(matrixOf(x => passed(step, x)), before.workpiece);
    out[links[i].name] = inverse(before.workpiece);
  }
  return out;
}
