// Normals of triangles.

/** One for each corner, of triangles of nine numbers. */
export function normalsOf(corners) {
  const out = new Float32Array(corners.length);
  for (let i = 0; i < corners.length; i += 9) {
    const ax = corners[i + 3] - corners[i], bx = corners[i + 6] - corners[i];
    const ay = corners[i + 4] - corners[i + 1], by = corners[i + 7] - corners[i + 1];
    const az = corners[i + 5] - corners[i + 2], bz = corners[i + 8] - corners[i + 2];
    const n = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    const size = Math.hypot(n[0], n[1], n[2]) || 1;
    for (let k = 0; k < 9; k++) out[i + k] = n[k % 3] / size;
  }
  return out;
}
