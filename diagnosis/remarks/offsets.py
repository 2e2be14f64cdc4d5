"""Features of which several touches are off together, each with its offset."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.twin.frames import IntArray


@dataclass(frozen=True, slots=True)
class OffTogether:
    """A feature that is dirty, damaged or wrongly calibrated, or a part of it."""

    feature: str
    run: str  # of several; "" of a single one
    lines: tuple[int, ...]  # of the run file that are off
    of: int  # touches of the feature
    size: float  # offset along the outward normal, mm
    u: float  # its standard uncertainty, mm
    place: tuple[float, ...]  # their middle in the artefact frame, mm

    @property
    def is_whole(self) -> bool:
        """Whether most touches of the feature are off."""
        return 2 * len(self.lines) > self.of


def off_together(fit: Fit) -> list[OffTogether]:
    """Features that are off in a fit, those with most touches first.

    None of these touches is in the fit. Their prediction errors e have the covariance

        C = S S^T + s^2 u_i u_j delta_ij,    c = (1^T C^-1 e) / (1^T C^-1 1)

    with the root S of the covariance of their predictions. Where they scatter about c by more than
    that, as dirt does, its standard uncertainty grows with the scatter (Birge ratio).
    """
    gross, touches = fit.gross, fit.run.touches
    if gross.together is None:
        return []
    rows = np.flatnonzero(gross.rows & gross.together)
    keys = np.column_stack([touches.run, np.unique(touches.feature, return_inverse=True)[1]])
    _, label = np.unique(keys, axis=0, return_inverse=True)
    each = [rows[label.ravel()[rows] == f] for f in np.unique(label.ravel()[rows])]
    allowed = fit.used | gross.rows
    out = []
    for own in sorted(each, key=len, reverse=True):
        size, u = _offset(fit, own)
        others = allowed & (label.ravel() == label.ravel()[own[0]])
        out.append(
            OffTogether(
                feature=str(touches.feature[own[0]]),
                run=touches.runs[touches.run[own[0]]] if len(touches.runs) > 1 else "",
                lines=tuple(int(line) for line in np.sort(fit.run.line[own])),
                of=int(others.sum()),
                size=size,
                u=u,
                place=tuple(float(x) for x in touches.point[own].mean(axis=0)),
            )
        )
    return out


def _offset(fit: Fit, rows: IntArray) -> tuple[float, float]:
    """Common offset of rows that are not in a fit, and its standard uncertainty, mm."""
    unit = fit.u[rows] * fit.weight
    spread = fit.solution.spread(fit.X[rows])
    W = np.linalg.inv((np.eye(len(rows)) + spread @ spread.T) * np.outer(unit, unit))
    error = fit.residual[rows]
    known = float(W.sum())
    size = float(W.sum(axis=0) @ error) / known
    left = error - size
    birge = float(left @ W @ left) / max(len(rows) - 1, 1)
    return size, float(np.sqrt(max(birge, 1.0) / known))
