"""A fit made again from its estimates: the same figures on the same rows, and nothing learnt anew.

What a model file keeps of a fit is the mode ``theta_m`` and the covariance ``C = L L^T`` of the
machine's parameters; where the standard stood is not kept. With the rows that the fit used, that is
enough. Given the machine the set-ups s follow by least squares, ``s = s_hat + K (theta_m - mode)``
with ``K = -(S^T S)^-1 S^T M`` (their prior among the rows), so the joint covariance has the root
``[[L, 0], [K L, R_s^-1]]``, and with it come leverages, left-out errors and degrees of freedom.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, rq, solve_triangular

from matstd.diagnosis.fit.identification import Fit, fit_run, noise_of, row_weight
from matstd.diagnosis.fit.prior import Prior
from matstd.diagnosis.regression import GrossErrors, Memory, Solution, solve, whitener
from matstd.twin.effects import setup_errors
from matstd.twin.frames import Array, Mask
from matstd.twin.model import Model, columns
from matstd.twin.record import Run


@dataclass(frozen=True, eq=False)
class Learnt:
    """What must be known of a fit, besides its run and its model, to make it again."""

    estimates: Prior  # estimates of the machine's parameters, inner parameters held
    from_inner: Array  # root (P, T) of the covariance that T uncertain inner parameters add to it
    factor: float  # noise over the stated one, as the fit weighted with
    gross: Mask  # rows that were set aside as gross errors, held out or not, (N,)
    memory: Memory | None = None  # correlation of the noise; None for white noise

    @classmethod
    def of(cls, fit: Fit) -> "Learnt":
        """What is kept of a fit."""
        count = len(fit.model.parameters)
        root = fit.spread[:count]
        return cls(
            estimates=Prior.of_estimates(fit.theta[:count], root @ root.T),
            from_inner=_from_inner(fit),
            factor=fit.noise.factor,
            gross=fit.gross.rows | fit.gross_test_rows,
            memory=fit.memory,
        )

    @property
    def covariance(self) -> Array:
        """Covariance of the estimates, that of inner parameters included, (P, P), base units."""
        root = self.estimates.root
        return np.asarray(root @ root.T + self.from_inner @ self.from_inner.T)

    def again(self, run: Run, model: Model) -> Fit:
        """The fit as it was.

        Args:
            run: The very run that it was made of, copies of rows set aside.
            model: Its machine and effects, at their inner parameters.
        """
        return _again(run, model, self)


def averaged(fits: Sequence[tuple[float, Fit]]) -> Fit:
    """One fit that predicts what models which a run does not distinguish predict on average.

    It has the effects of all. With m_k and C_k the estimates of model k and their covariance, zero
    for what it lacks, and s_k its share, the mixture has

        m = sum s_k m_k,    C = sum s_k (C_k + (m_k - m) (m_k - m)^T),

    so every prediction, linear in the parameters, is the average of theirs, and its variance has
    their disagreement besides their own. Which model it is counts as an inner parameter does: no
    touch has less noise for it. The variance of the noise is the average, too; gross errors are
    those of the first.

    Args:
        fits: Shares, 1 together, and fits to one run. What several of them have is one object.

    Reference:
        Hoeting, Madigan, Raftery, Volinsky, Statistical Science 14 (1999): model averaging.
    """
    first = fits[0][1]
    effects = {id(e): e for _, fit in fits for e in fit.model.effects}
    model = Model(first.model.chain, tuple(effects.values()))
    owner = np.array([id(e) for e, _ in model.parameters])
    mean, held, inner = np.zeros(len(owner)), np.zeros((len(owner),) * 2), list[Array]()
    estimates = []
    for share, fit in fits:
        own = np.concatenate([np.flatnonzero(owner == id(e)) for e in fit.model.effects])
        among, learnt = np.eye(len(owner))[:, own], Learnt.of(fit)
        estimates.append(among @ learnt.estimates.mean)
        mean += share * estimates[-1]
        root = among @ learnt.estimates.root
        held += share * root @ root.T
        inner.append(share**0.5 * among @ learnt.from_inner)
    shares = np.array([share for share, _ in fits])
    if len(fits) > 1:
        inner.append((np.transpose(estimates) - mean[:, None]) * shares**0.5)
    factors = np.array([fit.noise.factor for _, fit in fits])
    learnt = Learnt(
        estimates=Prior.of_estimates(mean, held),
        from_inner=np.hstack(inner),
        factor=float(np.sqrt(shares @ factors**2)),
        gross=first.gross.rows | first.gross_test_rows,
        memory=first.memory,
    )
    return learnt.again(first.run, model)


def _again(run: Run, model: Model, learnt: Learnt) -> Fit:
    """The fit of a model to a run as it was, from what was kept of it."""
    setups = setup_errors(run.touches)
    train = run.split != "test"
    used = train & ~learnt.gross
    A = columns((*model.effects, *setups), run.touches) / run.u[:, None]
    y = run.deviation / run.u
    if learnt.memory is not None and learnt.memory.is_filtered:
        filter_ = whitener(learnt.memory, run.touches, run.u, used)
        A[used], y[used] = filter_.filtered(A[used]), filter_.filtered(y[used])
    whole = learnt.factor * row_weight(learnt.memory)
    prior = learnt.estimates.joined(Prior.of_effects(setups))
    X, rest = A @ prior.root / whole, (y - A @ prior.mean) / whole
    # the machine stays as it was learnt; only the set-ups are fitted again
    solution = _solution(X[used], rest[used], len(learnt.estimates))
    left = (rest - X @ solution.phi) * whole
    return Fit(
        run=run,
        model=model,
        setups=setups,
        tangents=(),
        prior=prior,
        X=X,
        y=rest,
        used=used,
        solution=solution,
        gross=_set_aside(learnt.gross, train),
        noise=noise_of(run, solution, left, used, learnt.factor),
        memory=learnt.memory,
        from_inner=learnt.from_inner,
    )


def _solution(X: Array, y: Array, machine: int) -> Solution:
    """Solution whose machine stays at its mode with unit covariance, the set-ups fitted beside."""
    M, S = X[:, :machine], X[:, machine:]
    free = solve(S, y)
    K = -solve_triangular(free.R, free.Q.T @ M, check_finite=False)
    joint = block_diag(np.eye(machine), free.root)
    joint[machine:, :machine] = K
    root = rq(joint, mode="full")[0]
    R = solve_triangular(root, np.eye(len(root)), check_finite=False)
    phi = np.concatenate([np.zeros(machine), free.phi])
    return Solution(X @ root, R, phi, y - X @ phi)


def _set_aside(gross: Mask, train: Mask) -> GrossErrors:
    """Gross errors as they were found, whatever their size was."""
    score = np.where(gross, np.inf, 0.0)
    return GrossErrors(rows=gross & train, size=np.zeros(len(gross)), score=score, limit=1.0)


def _from_inner(fit: Fit) -> Array:
    """Root (P, T) of the covariance that T uncertain inner parameters add to P of the machine.

    From a fit with their tangents, ``C_pd C_dd^-1/2`` with d the displacements; of a fit that was
    made again it is known.
    """
    if fit.from_inner is not None:
        return fit.from_inner
    count = len(fit.model.parameters)
    prior = Prior(fit.prior.mean[:count], fit.prior.root[:count, :count])
    theta = fit.theta[:count]
    free = fit_run(fit.run, fit.model, prior, theta, fit.gross, fit.memory)
    if not free.tangents:
        return np.zeros((count, 0))
    last = slice(len(free.prior) - len(free.tangents), None)
    L = np.linalg.cholesky(free.covariance[last, last])
    cross = free.covariance[:count, last]
    return np.asarray(solve_triangular(L, cross.T, lower=True, check_finite=False).T)
