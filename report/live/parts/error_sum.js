// Errors of a machine at a pose, from their Chebyshev series (`report/machine/error_series.py`).

/**
 * The errors of a page: list of { name, words, series }; low, high: of every reading and, last, of
 * the time. `weights`: one factor each, 0 switches off.
 */
export class ErrorSum {
  constructor(machine, functions, low, high) {
    Object.assign(this, { machine, functions, low, high });
    this.weights = new Float64Array(functions.length).fill(1);
    // degree that is needed of every reading
    this.degree = low.map(() => 0);
    for (const { series } of functions) {
      for (const one of series) {
        one.readings.forEach((r, k) => {
          this.degree[r] = Math.max(this.degree[r], one.coefficients.shape[k] - 1);
        });
      }
    }
    this.chebyshev = this.degree.map(n => new Float64Array(n + 1));
  }

  /** Polynomials at readings with the time behind them. */
  at(x) {
    this.chebyshev.forEach((T, r) => {
      const u = (2 * x[r] - (this.low[r] + this.high[r])) / (this.high[r] - this.low[r]);
      T[0] = 1;
      if (T.length > 1) T[1] = u;
      for (let k = 2; k < T.length; k++) T[k] = 2 * u * T[k - 1] - T[k - 2];
    });
  }

  value({ coefficients: { values, shape }, readings }) {
    const [T, U, V] = readings.map(r => this.chebyshev[r]);
    if (!readings.length) return values[0];
    let sum = 0, at = 0;
    for (let i = 0; i < shape[0]; i++) {
      if (readings.length === 1) sum += T[i] * values[at++];
      for (let j = 0; readings.length > 1 && j < shape[1]; j++) {
        if (readings.length === 2) sum += T[i] * U[j] * values[at++];
        for (let k = 0; readings.length > 2 && k < shape[2]; k++) {
          sum += T[i] * U[j] * V[k] * values[at++];
        }
      }
    }
    return sum;
  }

  /**
   * Errors at a pose, added to `out`.
   * x: readings and time; sides: sign of the last motion of every axis; which: number of one error,
   * or all of them by their weights.
   */
  add(x, sides, out, which = -1) {
    this.at(x);
    this.functions.forEach((one, k) => {
      const weight = which < 0 ? this.weights[k] : which === k ? 1 : 0;
      if (!weight) return;
      for (const series of one.series) {
        const { side } = series;
        if (side && sides[side[0]] !== side[1]) continue;
        out[series.part][6 * series.link + series.component] += weight * this.value(series);
      }
    });
    return out;
  }
}
