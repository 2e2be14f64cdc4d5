"""Identification: the parameters of a model from a run, with a prior, whatever the noise."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.diagnosis.fit.inner import Tangent, tangents
from matstd.diagnosis.fit.prior import Prior
from matstd.diagnosis.fit.suited_prior import narrowed, widened_by, widening
from matstd.diagnosis.regression import (
    Features,
    GrossErrors,
    LeftOut,
    Memory,
    Noise,
    Solution,
    Whitener,
    find_gross,
    left_out,
    noise_factor,
    replicate_factor,
    shots,
    solve,
    whitener,
)
from matstd.twin.display import Displayed
from matstd.twin.effects import Free, placing_errors, setup_errors
from matstd.twin.errors import NotEnoughData
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.model import Effect, Model, Parameter, columns
from matstd.twin.numbers import rms
from matstd.twin.record import Run

MAX_PASSES = 5
SETTLED_CHANGE = 0.005
"""Most passes of a fit, and the relative change of the noise below which it weights with the noise
that it finds: gross errors and the widening of the prior then stay what they are."""

MIN_POSES = 4  # of fewer, one held out leaves the fit with less than three quarters
BLOCKS = 10
"""With fewer table poses than that, held out are so many blocks of touches one after the other."""

MAX_BY_CHANCE = 3.0  # standard deviations of the number of accidents that chance may add

MIN_TOUCHES = 8
"""Fewer touches than this do not even place a standard and leave something to judge it by."""


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Displayed):
    """A model fitted to a run.

    Parameters stand in the order: effects of the model, set-ups, tangents of inner parameters.

    Attributes:
        setups: The free set-ups of the standard, every further stylus, and its size where stated.
        tangents: Displacements of inner parameters that were left free.
        prior: Prior of all parameters, as it was used.
        X: Columns of all rows times the root of the prior over the noise, (N, P).
        y: Deviations over the noise, less what the prior's mean predicts, all rows, (N,).
        used: Rows that the estimates rest upon, (N,): not held out, no gross error.
        noise: What the noise is, against what is stated.
        widened: Factor by which the prior of the machine was widened, 1 unless it was exceeded.
        memory: Correlation of the noise, of which `X`, `y` and `solution` are already free in the
            rows used; None for white noise.
        from_inner: Root of the covariance that uncertain inner parameters add, where the fit was
            made again; None where it follows from the run.
    """

    run: Run  # the measurements
    model: Model  # chain and effects
    setups: tuple[Free, ...]
    tangents: tuple[Tangent, ...]
    prior: Prior
    X: Array
    y: Array
    used: Mask
    solution: Solution  # estimates, their covariance and the residual of the rows used
    gross: GrossErrors  # touches that were left out
    noise: Noise
    widened: float = 1.0
    memory: Memory | None = None
    from_inner: Array | None = None

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """Everything with parameters in this fit."""
        return (*self.model.effects, *self.setups, *self.tangents)

    @cached_property
    def parameters(self) -> tuple[tuple[Effect, Parameter], ...]:
        """Every parameter with its effect."""
        return tuple((e, p) for e in self.effects for p in e.parameters)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """`effect: parameter`, or the effect alone where it has one parameter."""
        return Model(self.model.chain, self.effects).names

    @property
    def theta(self) -> Array:
        """Estimates, (P,), base units."""
        return self.prior.mean + self.prior.root @ self.solution.phi

    @cached_property
    def spread(self) -> Array:
        """Root of the covariance of the estimates, (P, P), base units."""
        return self.prior.root @ self.solution.root

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the estimates, (P, P), base units."""
        return self.spread @ self.spread.T

    @property
    def u(self) -> Array:
        """Standard uncertainty of every touch as found, (N,), mm."""
        return self.run.u * self.noise.factor

    @cached_property
    def residual(self) -> Array:
        """Measured minus predicted, all rows, (N,), mm.

        Without a touch in use the place of the standard in a set-up is unknown: its rows are
        freed of that, so that they show how well the machine is predicted.
        """
        z = (self.y - self.X @ self.solution.phi) * self.weight
        if self.whitener is not None:
            z[self.used] = self.whitener.coloured(z[self.used])
        for rows, part in self.unseen_setups:
            S = self.X[rows, part]
            z[rows] -= S @ np.linalg.lstsq(S, z[rows], rcond=None)[0]
        return z * self.u

    @cached_property
    def unseen_setups(self) -> tuple[tuple[IntArray, slice], ...]:
        """Rows and parameters of every set-up, or further stylus, without a touch that was used."""
        t = self.run.touches
        rows = [(np.flatnonzero(s.here(t)), s.name) for s in placing_errors(t)]
        return tuple((r, self.of_effect(name)) for r, name in rows if not self.used[r].any())

    @property
    def weight(self) -> float:
        """Factor on the uncertainty of a row that counts for less than one observation."""
        return row_weight(self.memory)

    @cached_property
    def whitener(self) -> Whitener | None:
        """Filter of the noise's memory over the rows used; None for white noise."""
        if self.memory is None or not self.memory.is_filtered:
            return None
        return whitener(self.memory, self.run.touches, self.u, self.used)

    @property
    def rms(self) -> float:
        """Root mean square residual of the rows used, mm."""
        return rms(self.residual[self.used])

    @cached_property
    def test_rows(self) -> Mask:
        """Rows that the file marks as held out, without gross errors, (N,)."""
        return (self.run.split == "test") & ~self.gross_test_rows

    @cached_property
    def gross_test_rows(self) -> Mask:
        """Held-out rows that no fit of this run predicts, as gross errors are, (N,).

        Accidents come as often there as in the fit; where there are more the model is wrong there,
        and all rows count.
        """
        held_out = self.run.split == "test"
        far = held_out & (np.abs(self.gross.score) > self.gross.limit)
        expected = self.gross.rows.sum() / max(self.used.sum(), 1) * held_out.sum()
        most = expected + MAX_BY_CHANCE * np.sqrt(expected)
        return far if far.sum() <= most else np.zeros_like(far)

    @cached_property
    def groups(self) -> tuple[IntArray, ...]:
        """Rows of the fit, by numbers within it, of every table pose in every set-up.

        With fewer than `MIN_POSES` poses blocks of touches in the order of probing instead, and so
        in a set-up of one pose: without any touch the place of the standard is unknown.
        """
        t = self.run.touches
        key = np.column_stack([t.setup, t.pose])[self.used]
        label = np.unique(key, axis=0, return_inverse=True)[1].reshape(-1)
        if label.max() + 1 < MIN_POSES:
            return tuple(np.array_split(np.arange(len(label)), min(BLOCKS, len(label))))
        groups = [np.flatnonzero(label == k) for k in range(label.max() + 1)]
        poses = np.bincount(np.unique(key, axis=0)[:, 0])
        cuts = [min(BLOCKS, len(g)) if poses[key[g[0], 0]] == 1 else 1 for g in groups]
        return tuple(p for g, n in zip(groups, cuts, strict=True) for p in np.array_split(g, n))

    @cached_property
    def held_out(self) -> LeftOut:
        """Every pose predicted by a fit to the other poses; whitened."""
        return left_out(self.solution.Q, self.solution.residual, self.groups)

    @cached_property
    def test_rms(self) -> float:
        """Plain root mean square error of held-out touches, mm: what a user meets on new ones.

        Where the file marks rows `test` that is their error. Else the poses left out one after the
        other say how much larger than the noise the errors are that their uncertainties do not
        account for, and the uncertainties of the whole fit what comes on top at these touches in
        another run, where a standard is placed anew: ``s^2 mean u_i^2 (1 + l_i - p_i)`` with s the
        weighted error of left-out poses, l_i the variance of the machine's prediction that no
        set-up takes up and p_i the share of a touch that its set-up takes. A pose far from all
        others, once left out, is extrapolated to, and a plain mean would show little else.
        """
        if self.test_rows.any():
            return rms(self.residual[self.test_rows])
        u, machine = self.u[self.used], ~self._is_setup
        X = self.X[self.used]
        if self.whitener is not None:
            X = np.stack([self.whitener.coloured(column) for column in X.T], axis=1)
        placed = solve(X[:, ~machine], np.zeros(len(X))).Q
        spread = X[:, machine] @ self.solution.root[machine]
        spread -= placed @ (placed.T @ spread)
        variance = 1.0 - (placed**2).sum(axis=1) + self.weight**2 * (spread**2).sum(axis=1)
        return self.weight * self.held_out.rms * float(np.sqrt(np.mean(u**2 * variance)))

    @cached_property
    def _is_setup(self) -> Mask:
        """Which parameters place the standard, (P,)."""
        first = len(self.model.parameters)
        count = sum(len(e.parameters) for e in self.setups)
        place = np.arange(len(self.prior))
        return (place >= first) & (place < first + count)

    @cached_property
    def held_out_errors(self) -> Array:
        """Error of every row used, predicted by a fit to the other poses, (n,), mm."""
        error, unit = self.held_out.error, self.weight * self.u[self.used]
        if self.whitener is None:
            return np.asarray(error * unit)
        # without group g the parameters move by root Q_g^T e_g; the rows themselves are coloured
        filter_, solution = self.whitener, self.solution
        out = filter_.coloured(solution.residual)
        X = np.stack([filter_.coloured(column) for column in self.X[self.used].T], axis=1)
        for rows in self.groups:
            out[rows] += X[rows] @ (solution.root @ (solution.Q[rows].T @ error[rows]))
        return np.asarray(out * unit)

    @cached_property
    def standardised_test_rms(self) -> float:
        """The same without the prediction's own uncertainty, mm, to be compared with the noise.

        The errors are weighted by how much larger than the noise they must be, since the parameters
        are uncertain where a pose is missing; a right model gives the noise itself. Held out are
        the rows that the file marks `test`, each by itself, else one pose after the other.
        """
        if self.test_rows.any():
            X = self.X.copy()
            for rows, part in self.unseen_setups:
                X[rows, part] = 0.0
            spread = (self.solution.spread(X[self.test_rows]) ** 2).sum(axis=1)
            error = self.residual[self.test_rows] / np.sqrt(1.0 + spread)
            return rms(error)
        return self.weight * self.held_out.rms * rms(self.u[self.used])

    def of_effect(self, name: str) -> slice:
        """Places of one effect's parameters; raises KeyError."""
        start = 0
        for effect in self.effects:
            count = len(effect.parameters)
            if effect.name == name:
                return slice(start, start + count)
            start += count
        raise KeyError(name)


def fit_run(
    run: Run,
    model: Model,
    prior: Prior | None = None,
    free_inner: Array | None = None,
    gross: GrossErrors | None = None,
    memory: Memory | None = None,
    beside: Fit | None = None,
) -> Fit:
    """Fit a model and the set-ups of the standard to the rows of a run that are not held out.

    The first pass finds the gross errors, the size of the noise and whether the machine exceeds its
    prior; the second weights with what was found, and more follow while the gross errors change.

    Args:
        prior: Prior of the parameters; None for what the effects state, less where the run says
            that the machine is better (`prior_for`).
        free_inner: Linear parameters of the model, at which tangents of its inner parameters are
            added to the fit; None leaves the inner parameters where they are.
        gross: Gross errors found before, to keep; None looks for them, as if noise were white.
        memory: Correlation of the noise; None for white noise.
        beside: A fit with more effects, whose size of the noise and widening of the prior are
            taken; None finds those of this model.

    Raises:
        NotEnoughData: So few touches that nothing can be said.
    """
    train = run.split != "test"
    if int(train.sum()) < MIN_TOUCHES:
        raise NotEnoughData(
            f"{int(train.sum())} touches, expected at least {MIN_TOUCHES}: fewer cannot even place "
            "the standard; add touches"
        )
    machine = prior_for(run, model, gross, memory) if prior is None else prior
    setups = setup_errors(run.touches)
    moved = () if free_inner is None else tuple(tangents(model, run.touches, free_inner))
    A = columns((*model.effects, *setups, *moved), run.touches) / run.u[:, None]
    y = run.deviation / run.u
    if memory is not None and memory.is_filtered:
        gross = gross or fit_run(run, model, prior, free_inner).gross
        kept = train & ~gross.rows
        filter_ = whitener(memory, run.touches, run.u, kept)
        A[kept], y[kept] = filter_.filtered(A[kept]), filter_.filtered(y[kept])
    free = Prior.of_effects((*setups, *moved))
    factor, widened, weight = 1.0, 1.0, row_weight(memory)
    groups = shots(run.touches), Features.of(run.touches)
    if beside is not None:
        factor, widened = beside.noise.factor, beside.widened
    for remaining in reversed(range(MAX_PASSES if beside is None else 1)):
        root = machine.root * widening(model.effects, widened)
        belief = Prior(machine.mean, root, machine.narrowed).joined(free)
        whole = factor * weight
        X, rest = A @ belief.root / whole, (y - A @ belief.mean) / whole
        solution, found = _solved(X, rest, train, gross, groups)
        chi2 = float(solution.residual @ solution.residual) * whole**2
        better = noise_factor(chi2, solution.dof)
        if abs(better / factor - 1.0) < SETTLED_CHANGE or not remaining:
            break
        factor = better
        if machine.narrowed is None:  # else the run chose its size already
            widened = max(widened, widened_by(solution, len(machine)) * widened)
    used = train & ~found.rows
    noise = noise_of(run, solution, (rest - X @ solution.phi) * whole, used, factor)
    return Fit(
        run=run,
        model=model,
        setups=setups,
        tangents=moved,
        prior=belief,
        X=X,
        y=rest,
        used=used,
        solution=solution,
        gross=found,
        noise=noise,
        widened=widened,
        memory=memory,
    )


def prior_for(
    run: Run,
    model: Model,
    gross: GrossErrors | None = None,
    memory: Memory | None = None,
    stated: Prior | None = None,
) -> Prior:
    """What the effects of a model state, less where a run says that its machine is better.

    Arguments and errors as of `fit_run`; `stated` where something else is believed of the effects.
    """
    stated = stated or Prior.of_effects(model.effects)
    fit = fit_run(run, model, stated, gross=gross, memory=memory)
    if fit.widened > 1.0 or not len(stated):
        return stated
    return narrowed(stated, model, fit.X[fit.used], fit.y[fit.used])


def row_weight(memory: Memory | None) -> float:
    """Root of the number of rows that count as one observation."""
    if memory is None or memory.is_filtered:
        return 1.0
    return float(np.sqrt(memory.per_independent))


def noise_of(run: Run, solution: Solution, z: Array, used: Mask, factor: float) -> Noise:
    """Noise of a fit; z are its residuals over the stated uncertainty, all rows, (N,)."""
    ratio = float(z[used] @ z[used]) / max(solution.dof, 1e-9)
    replicates, count = replicate_factor(run, z, used)
    return Noise(
        factor=factor,
        dof=solution.dof,
        chi2_ratio=ratio,
        replicates=replicates,
        replicates_dof=count,
    )


def _solved(
    X: Array, y: Array, train: Mask, gross: GrossErrors | None, groups: tuple[IntArray, Features]
) -> tuple[Solution, GrossErrors]:
    """Fit with gross errors looked for, or kept as they were found before."""
    if gross is None:
        return find_gross(X, y, train, *groups)
    used = train & ~gross.rows
    return solve(X[used], y[used]), gross
