// Fitted and held-out error of any set of effects, from the matrices of `diagnosis/reduced`.
//
// A set is a list of columns, each a mix of stored ones: [[index, weight], ...]; the last column of
// a set is the deviation. Matrices are upper triangles, row by row.

const MAX_PASSES = 5, SETTLED = 0.005, PRIOR_DOF = 4;

/** Place of element (i, j), i <= j, in a triangle of a matrix of n rows. */
function place(i, j, n) {
  return i <= j ? i * n - i * (i - 1) / 2 + j - i : j * n - j * (j - 1) / 2 + i - j;
}

/** Which elements of a triangle of n rows make up the triangle of T^T M T, and with what weights. */
function planned(columns, n) {
  const at = [], by = [], ends = [];
  columns.forEach((column, a) => columns.slice(a).forEach(other => {
    for (const [i, w] of column) {
      for (const [j, v] of other) {
        at.push(place(i, j, n));
        by.push(w * v);
      }
    }
    ends.push(at.length);
  }));
  return { k: columns.length, at: Int32Array.from(at), by: Float64Array.from(by), ends };
}

/**
 * T^T M T as a full matrix in rows; M: the sum of triangles, with their weights, that begin at
 * `first`. Groups and steps of a ladder make this the inner loop: it holds nothing but numbers.
 */
function mixed(triangles, weights, first, { k, at, by, ends }) {
  const out = new Float64Array(k * k);
  for (let a = 0, m = 0, pair = 0; a < k; a++) {
    for (let b = a; b < k; b++, pair++) {
      let sum = 0;
      for (; m < ends[pair]; m++) {
        let value = 0;
        for (let l = 0; l < triangles.length; l++) value += weights[l] * triangles[l][first + at[m]];
        sum += by[m] * value;
      }
      out[a * k + b] = out[b * k + a] = sum;
    }
  }
  return out;
}

/** Lower factor of Cholesky of a full matrix in rows. */
function factorised(S, k) {
  const L = new Float64Array(k * k);
  for (let i = 0; i < k; i++) {
    for (let j = 0; j <= i; j++) {
      let sum = S[i * k + j];
      for (let m = 0; m < j; m++) sum -= L[i * k + m] * L[j * k + m];
      L[i * k + j] = i === j ? Math.sqrt(Math.max(sum, 1e-300)) : sum / L[j * k + j];
    }
  }
  return L;
}

/** Solution of S x = b by its factor. */
function solved(L, k, b) {
  const x = Float64Array.from(b);
  for (let i = 0; i < k; i++) {
    for (let m = 0; m < i; m++) x[i] -= L[i * k + m] * x[m];
    x[i] /= L[i * k + i];
  }
  for (let i = k - 1; i >= 0; i--) {
    for (let m = i + 1; m < k; m++) x[i] -= L[m * k + i] * x[m];
    x[i] /= L[i * k + i];
  }
  return x;
}

/** Trace of S^-1 H; H full, of rows `wide`. */
function traceSolved(L, k, H, wide) {
  let sum = 0;
  const column = new Float64Array(k);
  for (let j = 0; j < k; j++) {
    for (let i = 0; i < k; i++) column[i] = H[i * wide + j];
    sum += solved(L, k, column)[j];
  }
  return sum;
}

function quadratic(c, H, k) {
  let sum = 0;
  for (let i = 0; i < k; i++) for (let j = 0; j < k; j++) sum += c[i] * c[j] * H[i * k + j];
  return sum;
}

export class Solver {
  /** reduced: as `report/run_view/run_data.py` packs it. */
  constructor(reduced) {
    Object.assign(this, reduced);
    this.triangle = this.size * (this.size + 1) / 2;
    const [low, high] = this.span.map(Math.log);
    this.within = s => Math.max(-1, Math.min(1, (2 * Math.log(s) - low - high) / (high - low)));
  }

  /** Weights of the terms at a size of the noise: Chebyshev's polynomials of its logarithm. */
  shares(s) {
    const angle = Math.acos(this.within(s));
    return this.terms.map((_, k) => Math.cos(k * angle));
  }

  /** The named matrix of a set at a size of the noise; `weights`: of the terms, null for the first. */
  matrix(name, plan, weights, first = 0) {
    const triangles = (weights ? this.terms : [this.first]).map(term => term[name].values);
    return mixed(triangles, weights || [1], first, plan);
  }

  number(name, weights) {
    if (!weights) return this.first[name];
    return weights.reduce((sum, w, l) => sum + w * this.terms[l][name], 0);
  }

  /**
   * Errors with a set: { fitted, heldOut, s, estimate, spread, c, groups }, in the unit of the data;
   * c: of the set's columns in the residual; groups: error of each group left out.
   */
  errors(columns) {
    const k = columns.length - 1, wide = k + 1, plan = planned(columns, this.size);
    let s = 1, weights = this.first ? null : this.shares(1), L, a, c;
    for (let left = MAX_PASSES - 1; left >= 0; left--) {
      const G = this.matrix("G", plan, weights), H2 = this.matrix("H2", plan, weights);
      const S = new Float64Array(k * k), whole = s * this.weight;
      for (let i = 0; i < k; i++) {
        for (let j = 0; j < k; j++) S[i * k + j] = G[i * wide + j] + (i === j ? whole ** 2 : 0);
      }
      L = factorised(S, k);
      a = solved(L, k, Float64Array.from({ length: k }, (_, i) => G[i * wide + k]));
      c = Float64Array.from({ length: wide }, (_, i) => (i < k ? -a[i] : 1));
      this.S = S;
      const dof = this.count - this.number("freedom", weights) - traceSolved(L, k, H2, wide);
      const better = Math.sqrt((quadratic(c, H2, wide) + PRIOR_DOF) / (Math.max(dof, 0) + PRIOR_DOF));
      if (Math.abs(better / s - 1) < SETTLED || !left) break;
      s = better;
      weights = this.shares(s);
    }
    const fitted = Math.sqrt(Math.max(quadratic(c, this.matrix("H1", plan, weights), wide), 0));
    const spread = this.spread(L, k, s * this.weight);
    const held = this.isTested
      ? this.ofTestRows(plan, c, weights) : this.leftOut(columns, plan, c, L, k, weights);
    return { fitted, s, estimate: a, spread, c, ...held };
  }

  /** Standard uncertainties of the estimates, in units of the prior. */
  spread(L, k, whole) {
    return Float64Array.from({ length: k }, (_, i) => {
      const unit = new Float64Array(k);
      unit[i] = 1;
      return whole * Math.sqrt(Math.max(solved(L, k, unit)[i], 0));
    });
  }

  ofTestRows(plan, c, weights) {
    const square = quadratic(c, this.matrix("tested", plan, weights), plan.k);
    return { heldOut: Math.sqrt(Math.max(square, 0)), groups: [] };
  }

  /** Every group predicted by a fit to the others, and what that means for another run. */
  leftOut(columns, plan, c, L, k, weights) {
    const wide = k + 1, squares = [], { S } = this;
    for (let g = 0; g < this.groupSizes.length; g++) {
      const F = this.matrix("F", plan, weights, g * this.triangle);
      const v = new Float64Array(k), own = new Float64Array(k * k);
      for (let i = 0; i < k; i++) {
        for (let j = 0; j < wide; j++) v[i] += F[i * wide + j] * c[j];
        for (let j = 0; j < k; j++) own[i * k + j] = S[i * k + j] - F[i * wide + j];
      }
      const x = solved(factorised(own, k), k, v);
      let square = quadratic(c, F, wide);
      for (let i = 0; i < k; i++) square += v[i] * x[i];
      squares.push(square);
    }
    const inner = planned(columns.slice(0, k), this.size - 1);
    const more = traceSolved(L, k, this.matrix("H3", inner, weights), k);
    const newRun = this.number("newRun", weights) + this.weight ** 2 * more;
    const total = squares.reduce((sum, q) => sum + q, 0);
    return {
      heldOut: Math.sqrt(Math.max(total / this.count * newRun, 0)),
      groups: squares.map((q, g) => Math.sqrt(Math.max(q / this.groupSizes[g] * newRun, 0))),
    };
  }
}

/** Weights of values at places x in the cubic through the four nearest ones to a place. */
export function cubicWeights(x, at) {
  const out = new Float64Array(x.length);
  if (x.length === 1) return out.fill(1);
  let i = 0;
  while (i < x.length - 2 && x[i + 1] < at) i++;
  const first = Math.max(0, Math.min(x.length - 4, i - 1)), last = Math.min(first + 4, x.length);
  for (let a = first; a < last; a++) {
    out[a] = 1;
    for (let b = first; b < last; b++) if (b !== a) out[a] *= (at - x[b]) / (x[a] - x[b]);
  }
  return out;
}
