"""What a user should know about a run besides the verdict, one clear line each."""

import numpy as np

from diagnosis.fit import MIN_POSES, Fit
from twin.units import UM

TOO_QUIET = 0.02
"""Deviations below this share of their stated uncertainty are in another unit."""

TOO_LOUD = 100.0
"""Noise above so many times the stated uncertainty is in another unit."""

FEW_DOF = 30.0
"""Below so many degrees of freedom only large effects can be seen."""

LISTED = 20
"""Gross errors whose lines are told."""


def remarks(fit: Fit) -> tuple[str, ...]:
    """Everything noteworthy in a fit, what the reader of the file noticed first."""
    out = list(fit.run.remarks)
    out += _units(fit) + _touches(fit) + _noise(fit) + _gross(fit)
    if fit.widened > 1.0:
        out.append(
            f"the machine's errors are about {fit.widened:.1f} times their stated distributions; "
            "the prior was widened by that"
        )
    return tuple(out)


def _units(fit: Fit) -> list[str]:
    """Units that look mixed up."""
    share = float(np.median(np.abs(fit.run.deviation) / fit.run.u))
    if share < TOO_QUIET:
        return [
            f"typical deviations are {share:.2g} of their stated uncertainty: are they in mm in a "
            "column of µm?"
        ]
    if fit.noise.factor > TOO_LOUD:
        return [
            f"the noise is {fit.noise.factor:.3g} times the stated uncertainty: is u_um in mm, or "
            "are the deviations in another unit?"
        ]
    return []


def _touches(fit: Fit) -> list[str]:
    """Too few touches or poses, and what is still possible."""
    out = []
    n, p = int(fit.used.sum()), len(fit.parameters)
    if n < p:
        out.append(
            f"{n} touches for {p} parameters: the prior decides the rest; the prediction where it "
            "was probed is still good, single parameters are not"
        )
    if fit.solution.dof < FEW_DOF:
        out.append(
            f"{fit.solution.dof:.0f} degrees of freedom are left for the noise: only large effects "
            "can be seen; the stated uncertainty is leant on"
        )
    t = fit.run.touches
    poses = len(np.unique(np.column_stack([t.setup, t.pose])[fit.used], axis=0))
    if poses < MIN_POSES:
        out.append(
            f"{poses} table pose{'s' if poses > 1 else ''} only: errors of the rotary axes cannot "
            "be seen, and touches are held out in blocks instead of by pose"
        )
    return out


def _noise(fit: Fit) -> list[str]:
    """Noise that is not what the file states."""
    noise = fit.noise
    u = float(np.median(fit.run.u)) / UM
    if noise.replicates is not None and noise.replicates_dof >= 10:
        ratio = noise.factor / noise.replicates
        if ratio > 1.0 + 3.0 * (0.5 / noise.replicates_dof) ** 0.5:
            return [
                f"residuals are {ratio:.2f} times as large as the scatter of {noise.replicates_dof}"
                " replicates: the model lacks something"
            ]
    if noise.is_wrongly_stated and noise.factor < TOO_LOUD:
        return [f"the noise looks like {noise.factor * u:.2f} µm, not {u:.2f} µm as stated"]
    return []


def _gross(fit: Fit) -> list[str]:
    """Touches that were left out."""
    gross = fit.gross
    if gross.too_many:
        return [
            "more touches stand out than accidents can explain: all were kept, and the residual "
            "is treated as structure"
        ]
    rows = np.flatnonzero(gross.rows)
    if len(rows) == 0:
        return []
    rows = rows[np.argsort(-np.abs(gross.score[rows]))]
    size = fit.residual[rows[0]] / UM
    side = "outside" if size > 0 else "inside"
    lines = ", ".join(str(line) for line in fit.run.line[rows[:LISTED]])
    more = f" and {len(rows) - LISTED} more" if len(rows) > LISTED else ""
    return [
        f"{len(rows)} gross error{'s were' if len(rows) > 1 else ' was'} left out, the largest "
        f"{abs(size):.1f} µm {side} what the other touches predict: "
        f"line{'s' if len(rows) > 1 else ''} {lines}{more}"
    ]
