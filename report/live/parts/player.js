// A program that was read, as positions between which every axis moves evenly.

/** program: { time, q, sides, line, touch ...}, typed arrays of K rows. */
export class Player {
  constructor(program, axes) {
    Object.assign(this, { program, axes, now: 0 });
    this.times = program.time.values;
    this.last = this.times[this.times.length - 1];
  }

  /** Number of the last position that is not after a time. */
  before(time) {
    let low = 0, high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time) low = middle; else high = middle - 1;
    }
    return low;
  }

  /** Where everything is at a time: { q, sides, time, row }, row: the position that is headed for. */
  at(time) {
    const { program, axes } = this, i = this.before(time);
    const j = Math.min(i + 1, this.times.length - 1), span = this.times[j] - this.times[i];
    const share = span > 0 ? Math.max(0, Math.min(1, (time - this.times[i]) / span)) : 0;
    const row = share > 0 ? j : i, q = new Float64Array(axes), sides = new Int8Array(axes);
    for (let a = 0; a < axes; a++) {
      const from = program.q.values[i * axes + a], to = program.q.values[j * axes + a];
      q[a] = from + share * (to - from);
      sides[a] = program.sides.values[row * axes + a];
    }
    return { q, sides, time, row };
  }

  /** Time of the next row, or with -1 of the one before, for which `is(row)` holds. */
  next(time, way, is) {
    for (let i = this.before(time + 1e-6) + way; i >= 0 && i < this.times.length; i += way) {
      if (is(i)) return this.times[i];
    }
    return way > 0 ? this.last : this.times[0];
  }

  /** At most so many rows, even over the program, the first and the last with them. */
  some(most) {
    const count = Math.min(most, this.times.length), end = this.times.length - 1;
    return Array.from({ length: count }, (_, k) => Math.round(k * end / Math.max(count - 1, 1)));
  }
}
