// The state of a set of effects: which are on, their gains and inner parameters; and its errors.

import { Solver, cubicWeights } from "./solver.js";

const MOST_KEPT = 200;  // sets of which the errors are kept

export class EffectBoard {
  /** data: of `report/run_view/run_data.py`, decoded. */
  constructor(data) {
    this.data = data;
    this.solver = new Solver(data.reduced);
    this.estimate = data.estimate.values;
    this.known = new Map(data.known.map(k => [k.on.join("\n"), k]));
    this.kept = new Map();  // errors of sets: steps of a ladder come again after the next switch
    let first = 0;
    this.switches = data.switches.map(one => {
      const made = { ...one, first, at: one.inner ? one.inner.present : 0, gain: null };
      made.isOn = one.isFound;
      made.value = one.inner ? one.inner.values.values[one.inner.present] : null;
      first += one.stored;
      return made;
    });
  }

  /** As the diagnosis left it. */
  reset() {
    for (const one of this.switches) {
      one.isOn = one.isFound;
      one.gain = null;
      if (one.inner) one.value = one.inner.values.values[one.inner.present];
    }
  }

  /** Switches one; look-alikes share what they explain, so that a second one replaces the first. */
  toggle(one, isOn) {
    one.isOn = isOn;
    if (!isOn) one.gain = null;
    if (isOn) for (const other of this.switches) if (this.areAlike(one, other)) other.isOn = false;
  }

  areAlike(one, other) {
    return one !== other && (one.alike.includes(other.name) || other.alike.includes(one.name));
  }

  /** Columns of an effect as mixes of stored ones, [[index, weight], ...] for each parameter. */
  mixes(one) {
    const [count, wide, stored] = one.mixes.shape, { values } = one.mixes;
    let shares = [1];
    if (one.inner) {
      const spaced = v => (one.inner.isRatio ? Math.log(v) : v);
      shares = cubicWeights([...one.inner.values.values].map(spaced), spaced(one.value));
    }
    return Array.from({ length: wide }, (_, k) => {
      const out = [];
      for (let m = 0; m < stored; m++) {
        let w = 0;
        for (let v = 0; v < count; v++) w += shares[v] * values[(v * wide + k) * stored + m];
        if (w !== 0) out.push([one.first + m, w]);
      }
      return out;
    });
  }

  /** The columns of a set; effects with a gain are taken off the deviation, with their amounts. */
  columns(on) {
    const columns = [], own = [], last = new Map();
    this.estimate.forEach((v, i) => v && last.set(i, v));
    last.set(this.estimate.length, 1);
    for (const one of on) {
      const parts = this.mixes(one);
      if (one.gain === null && !one.isFixed) {
        own.push([one, columns.length]);
        columns.push(...parts);
      } else {
        const amounts = this.amounts(one);
        parts.forEach((part, k) => part.forEach(([i, w]) => {
          last.set(i, (last.get(i) || 0) - amounts[k] * w);
        }));
      }
    }
    columns.push([...last]);
    return { columns, own };
  }

  /** Amounts of an effect that is on, in units of the prior; found: of the fit, if they are free. */
  amounts(one, found = null) {
    if (one.isFixed) return [one.gain ?? 1];
    if (one.gain !== null) return one.pinned.map(v => one.gain * v);
    const place = found.own.find(([other]) => other === one)[1];
    return found.estimate.slice(place, place + one.amounts.length);
  }

  get on() {
    return this.switches.filter(one => one.isOn);
  }

  /** Whether nothing is moved: neither a gain nor an inner parameter. */
  isPlain(on) {
    return on.every(one => one.gain === null
      && !this.isMoved(one));
  }

  /** Errors of a set; of sets that were fitted to the touches the figures of that fit. */
  errors(on = this.on) {
    const state = on.map(one => [one.name, one.value, one.gain, one.gain && [...one.pinned]]);
    const key = JSON.stringify(state);
    if (!this.kept.has(key)) {
      if (this.kept.size > MOST_KEPT) this.kept.clear();
      this.kept.set(key, this.solved(on));
    }
    return this.kept.get(key);
  }

  solved(on) {
    const { columns, own } = this.columns(on), found = this.solver.errors(columns);
    const known = this.isPlain(on) && this.known.get(on.map(one => one.name).sort().join("\n"));
    if (known) Object.assign(found, { fitted: known.fitted, heldOut: known.heldOut });
    const isAsFound = this.isPlain(on) && this.switches.every(one => one.isFound === on.includes(one));
    return { ...found, columns, own, isAsFound };
  }

  /** Errors with what was found, as the command left it. */
  asFound() {
    return this.known.get(this.switches.filter(one => one.isFound).map(one => one.name).sort()
      .join("\n"));
  }

  /** Fixes the amounts of an effect at a multiple of what is fitted now; null: fitted again. */
  pull(one, gain) {
    if (gain !== null && one.gain === null) one.pinned = this.amounts(one, this.errors());
    one.gain = gain;
  }

  /** Residual of every touch. */
  residuals({ columns, c, s }) {
    const { last, first, change } = this.data.residuals, weights = new Map();
    columns.forEach((column, k) => column.forEach(([i, w]) => {
      weights.set(i, (weights.get(i) || 0) + w * c[k]);
    }));
    const share = change ? Math.log(s / last) / Math.log(first / last) : 0;
    return this.summed(weights, Math.max(0, Math.min(1, share)));
  }

  /** What an effect does to the residuals as it is fitted now, geometry refitted. */
  contribution(one, found) {
    const weights = new Map(), amounts = this.amounts(one, found);
    this.mixes(one).forEach((part, k) => {
      part.forEach(([i, w]) => weights.set(i, (weights.get(i) || 0) + amounts[k] * w));
    });
    return this.summed(weights, 0);
  }

  /** Weighted stored columns at a share of the way from the last fit's noise to the first one's. */
  summed(weights, share) {
    const { columns, change } = this.data.residuals, n = this.data.touches.count;
    const out = new Float32Array(n);
    for (const [i, w] of weights) {
      const start = i * n;
      for (let t = 0; t < n; t++) out[t] += w * columns.values[start + t];
      if (share) for (let t = 0; t < n; t++) out[t] += w * share * change[i].values[t];
    }
    return out;
  }

  /** Amount of an effect now over the one that was found; 0 where it is off. */
  share(one, now) {
    if (!one.isOn) return 0;
    let [dot, square] = [0, 0];
    this.amounts(one, now).forEach((amount, k) => {
      const found = this.estimate[one.first + k];
      dot += found * amount;
      square += found * found;
    });
    return square ? dot / square : 0;
  }

  /** Whether the inner parameter of an effect was moved. */
  isMoved(one) {
    return one.inner !== null && one.value !== one.inner.values.values[one.inner.present];
  }

  /** Held-out error that a switch would bring. */
  scent(one) {
    const others = this.on.filter(other => other !== one && (one.isOn || !this.areAlike(one, other)));
    if (one.isOn) return this.errors(others).heldOut;
    return this.errors(this.switches.filter(s => others.includes(s) || s === one)).heldOut;
  }
}
