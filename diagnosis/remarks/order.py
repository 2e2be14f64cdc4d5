"""A jump in what is left, at a row of a run without times: rows may stand in order all the same."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.fit import Fit, fit_run
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import f_probability, solve
from matstd.twin.frames import Array, IntArray
from matstd.twin.record import Instrument

MIN_MOMENTS = 20  # moments (rows of the file, or poses) from which a run has a before and an after
COMPONENTS = 3  # components of a displacement
PRIOR_SD = 10.0  # what is believed of it, mm
SETTLING_PASSES = 4  # times that the noise is found anew with it; three settle it


@dataclass(frozen=True, slots=True)
class JumpInOrder:
    """What is left is displaced from a row on, in a run without times."""

    before: int  # last line of the run file before it
    after: int  # first line after it
    size: float  # displacement, mm
    u: float  # its standard uncertainty, mm


def jump_in_order(fit: Fit) -> JumpInOrder | None:
    """The likeliest displacement of everything from a row on, if it is beyond chance.

    Moments count as independent, not the rows that share one: an F test with three degrees of
    freedom, corrected for the number of places that it may have.
    """
    t = fit.run.touches
    is_cmm = (
        t.instrument is Instrument.CMM
    )  # its rows are sorted by names, the part was made before
    if is_cmm or np.ptp(t.time) > 0.0 or len(t.runs) > 1 or t.instrument.reads_angle:
        return None
    if fit.memory is not None and fit.memory.is_filtered:
        fit = fit_run(fit.run, fit.model, gross=fit.gross)
    line, pose = fit.run.line[fit.used], t.pose[fit.used]
    order = np.argsort(line, kind="stable")
    line = line[order]
    first = np.flatnonzero(np.diff(pose[order], prepend=-1) != 0)
    if len(first) < MIN_MOMENTS or len(np.unique(pose)) < len(first):
        return None
    N = (t.normal_table / (fit.u * fit.weight)[:, None])[fit.used][order]
    fall = _falls(N, fit.solution.Q[order], fit.solution.residual[order], first)
    k = int(np.argmax(fall))
    share, dof = min(fall[k] / fit.solution.objective, 1.0), len(first) - 2 * COMPONENTS
    p = float(f_probability(share, COMPONENTS, 1.0 - share, dof)) * len(fall)
    if p > POLICY.close_p or share < POLICY.jump_share:
        return None
    after = np.arange(len(line)) >= first[k + 1]
    X, y = fit.X[fit.used][order], fit.y[fit.used][order]
    size, u = _size(X, y, N * after[:, None], COMPONENTS * len(first))
    return JumpInOrder(int(line[first[k + 1] - 1]), int(line[first[k + 1]]), size, u)


def _size(X: Array, y: Array, N: Array, independent: int) -> tuple[float, float]:
    """A displacement with its uncertainty, mm, beside all that a fit has free.

    With the displacement the noise is smaller: it is found anew, and so is the rest.
    """
    factor = 1.0
    for _ in range(SETTLING_PASSES):
        found = solve(np.column_stack([X, PRIOR_SD * N]) / factor, y / factor)
        factor *= float(np.sqrt(found.objective / max(found.dof, 1.0)))
    step = PRIOR_SD * found.phi[-COMPONENTS:]
    size = float(np.linalg.norm(step))
    u = PRIOR_SD * float(np.linalg.norm(step / size @ found.root[-COMPONENTS:]))
    return size, u * float(np.sqrt(max(len(y) / independent, 1.0)))


def _falls(N: Array, Q: Array, r: Array, first: IntArray) -> Array:
    """Fall of the objective with a displacement from every moment but the first on, (M - 1,).

    Args:
        N: Normals over the noise, (N, 3).
        Q: Basis of what the fit has free, (N, P).
        r: What it leaves, (N,).
        first: First row of every moment, (M,).
    """

    def from_on(rows: Array) -> Array:
        sums = np.add.reduceat(rows, first, axis=0)
        return np.asarray(sums[::-1].cumsum(axis=0)[::-1][1:])

    C = from_on(N[:, :, None] * Q[:, None, :])
    A = from_on(N[:, :, None] * N[:, None, :]) - C @ C.swapaxes(1, 2)
    b = from_on(N * r[:, None])
    return np.einsum("ki,kij,kj->k", b, np.linalg.pinv(A, rcond=1e-9, hermitian=True), b)
