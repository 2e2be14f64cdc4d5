"""What several runs of one machine tell of its course, and how well each of them is known."""

from dataclasses import dataclass, replace

import numpy as np

from diagnosis.fit import Fit, fit_run
from diagnosis.geometry import GeometryRow, changed_since, changing
from twin.frames import Array


@dataclass(frozen=True, slots=True)
class RunErrors:
    """How well one of several runs is known, mm.

    Attributes:
        name: Of the run.
        touches: Its rows, gross errors left out.
        rms: Root mean square residual of those that were fitted; None if the run was held out.
        test_rms: Plain error of its poses, each predicted by all others; None likewise.
        left_out: Plain error of the whole run, its set-ups fitted, the machine predicted by the
            other runs: as in the run before, of the first run as in the one after. None where no
            other run was fitted.
    """

    name: str
    touches: int
    rms: float | None
    test_rms: float | None
    left_out: float | None

    @property
    def is_held_out(self) -> bool:
        """Whether the diagnosis was made without it."""
        return self.rms is None


@dataclass(frozen=True, slots=True, eq=False)
class Trend:
    """What changed between several runs of one machine, and what did not.

    Attributes:
        runs: In their order.
        changed: Runs, by number, whose geometry differs from that of the run before; 0 stands for
            the first beside the model that the diagnosis began with.
        rows: The geometry with its course, every run by itself.
        settled: The same with runs between which nothing changed as one: what did change is known
            better by it.
    """

    runs: tuple[RunErrors, ...]
    changed: tuple[int, ...]
    rows: tuple[GeometryRow, ...]
    settled: tuple[GeometryRow, ...]

    def known_best(self, run: int) -> tuple[GeometryRow, ...]:
        """The rows, in the same order, by which what changed into a run is known best."""
        return self.settled if run in self.changed else self.rows


def run_errors(fit: Fit) -> tuple[RunErrors, ...]:
    """Figures of every run of a fit."""
    run_of = fit.run.touches.run
    held_out, out = fit.held_out_errors, []
    for i, name in enumerate(fit.run.touches.runs):
        rows, own = fit.used & (run_of == i), run_of[fit.used] == i
        is_fitted = bool(rows.any())
        counted = rows if is_fitted else fit.test_rows & (run_of == i)
        others = _without(fit, i) if is_fitted else fit
        out.append(
            RunErrors(
                name=name,
                touches=int(counted.sum()),
                rms=_rms(fit.residual[rows]) if is_fitted else None,
                test_rms=_rms(held_out[own]) if is_fitted else None,
                left_out=None if others is None else _rms(others.residual[counted]),
            )
        )
    return tuple(out)


def _without(fit: Fit, run: int) -> Fit | None:
    """The fit to the other runs alone; None where there is no other."""
    touches = fit.run.touches
    others = [i for i in np.unique(touches.run[fit.used]) if i != run]
    if not others:
        return None
    # what changed since a run that nobody has seen is nobody's guess
    since = [i for i in changed_since(fit.model) if i in others[1:]]
    split = np.where(fit.used & (touches.run != run), "", "test")
    model = changing(fit.model, touches, since)
    return fit_run(replace(fit.run, split=split), model, gross=fit.gross, memory=fit.memory)


def _rms(errors: Array) -> float:
    return float(np.sqrt(np.mean(errors**2)))
