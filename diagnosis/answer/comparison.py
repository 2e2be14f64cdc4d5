"""Measurements against a model: residuals, what they vary with, and where the model fails."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from matstd.diagnosis.accuracy import (
    Promise,
    Repeatability,
    machine_variance,
    promise,
    repeatability,
)
from matstd.diagnosis.evidence import EffectSet, Progress, ResidualSpace, quiet
from matstd.diagnosis.faults import DescriptionFault, description_faults
from matstd.diagnosis.fit import Fit, Learnt, Prior, fit_run
from matstd.diagnosis.geometry import LearntGeometry, learnt_geometry
from matstd.diagnosis.remarks import Remark, remarks
from matstd.diagnosis.residual import Region, Structure, find_structure, regions
from matstd.twin.compute import one_blas_thread
from matstd.twin.display import Tabular
from matstd.twin.frames import Array, Mask
from matstd.twin.library import ordinary_model
from matstd.twin.model import Model
from matstd.twin.numbers import rms
from matstd.twin.record import Run, with_commanded, without_copies
from matstd.twin.units import UM


@dataclass(frozen=True, slots=True)
class GroupResidual:
    """Residuals of the touches of one table pose, or on one feature."""

    name: str  # `setup a, pose 3`, or the feature
    touches: int
    mean: float  # mean residual, mm
    rms: float  # root mean square residual, mm
    normalised: float  # root mean square over the standard uncertainty


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Tabular):
    """A run against a model.

    Attributes:
        fit: The model on this run: with a model from a file its machine is as it was estimated
            before, and only the set-ups of the standard are fitted; else all is.
        is_prediction: Whether the machine was known before this run.
        u: Standard uncertainty of the difference of every touch, (N,), mm: of the touch as stated,
            and of the prediction where it was made without this run.
        structure: What the residual varies with, the most certain first.
        where: Regions where the model fails.
        geometry: What the run says of the machine's geometry, and what of it changed since the
            model was made, if it is one of an earlier run.
        repeatability: Scatter of repeated touches, whatever the model.
        promise: Errors to expect of the fitted model; None of a prediction, which `expected` has.
        learnt: The fit that the model was learnt by, where that was from this very run: its
            figures are those reported then.
    """

    fit: Fit
    is_prediction: bool
    u: Array
    structure: tuple[Structure, ...]
    where: tuple[Region, ...]
    geometry: LearntGeometry
    repeatability: Repeatability
    promise: Promise | None
    faults: tuple[
        DescriptionFault, ...
    ]  # mistakes of the machine file or the set-up that explain it
    remarks: tuple[Remark, ...]  # what else the user should know
    learnt: Fit | None = None

    number_format = ".4f"  # a tenth of a nanometre

    @property
    def run(self) -> Run:
        """The measurements."""
        return self.fit.run

    def columns(self) -> dict[str, list[Any]]:
        """Every touch: measured, predicted, residual, as in `residuals.csv`."""
        t, gross = self.run.touches, self.fit.gross.rows | self.fit.gross_test_rows
        return {
            "line": self.run.line.tolist(),
            "feature": t.feature.tolist(),
            "setup": [t.setups[i].name for i in t.setup],
            "pose": t.pose.tolist(),
            "measured_um": (self.run.deviation / UM).tolist(),
            "predicted_um": (self.predicted / UM).tolist(),
            "residual_um": (self.residual / UM).tolist(),
            "normalised": self.normalised.tolist(),
            "gross_error": gross.astype(int).tolist(),
        }

    @property
    def residual(self) -> Array:
        """Measured minus predicted, (N,), mm; gross errors included."""
        return self.fit.residual

    @property
    def normalised(self) -> Array:
        """Residuals over their standard uncertainty, (N,)."""
        return self.residual / self.u

    @property
    def predicted(self) -> Array:
        """Deviation that the model predicts, (N,), mm."""
        return self.run.deviation - self.residual

    @property
    def counted(self) -> Mask:
        """Rows that the figures are taken over: all but gross errors, (N,)."""
        return ~(self.fit.gross.rows | self.fit.gross_test_rows)

    @cached_property
    def rms(self) -> float:
        """Root mean square residual, mm."""
        return rms(self.residual[self.counted])

    @property
    def rms_measured(self) -> float:
        """Root mean square of the measured deviations, mm."""
        return rms(self.run.deviation[self.counted])

    @property
    def scatter(self) -> float:
        """Standard deviation of the residual, degrees of freedom accounted for, mm."""
        return self.repeatability.stated * self.fit.noise.factor

    @property
    def expected(self) -> float:
        """Error to expect at these touches of what is known of the machine, rms, mm."""
        return rms(self.u[self.counted])

    @property
    def worst(self) -> int:
        """Row of the largest normalised residual among those counted."""
        return int(np.argmax(np.abs(self.normalised) * self.counted))

    @property
    def chi2_ratio(self) -> float:
        """Weighted squared residual per degree of freedom."""
        z = self.normalised[self.counted]
        return float(z @ z) / max(float(len(z)) - self.fit.solution.effective_parameters, 1e-9)

    @property
    def poses(self) -> tuple[GroupResidual, ...]:
        """Residuals by table pose, in the order of probing."""
        t = self.run.touches
        names = np.array([s.name for s in t.setups])[t.setup]
        labels = np.char.add(np.char.add(names, ", pose "), t.pose.astype(str))
        return self._grouped(np.char.add("setup ", labels))

    @property
    def features(self) -> tuple[GroupResidual, ...]:
        """Residuals by feature of the standard."""
        return self._grouped(self.run.touches.feature)

    def _grouped(self, labels: np.ndarray) -> tuple[GroupResidual, ...]:
        out = []
        for name in dict.fromkeys(labels[self.counted]):
            rows = self.counted & (labels == name)
            r, z = self.residual[rows], self.normalised[rows]
            rms, normalised = np.sqrt(np.mean(r**2)), np.sqrt(np.mean(z**2))
            out.append(
                GroupResidual(
                    name=str(name),
                    touches=int(rows.sum()),
                    mean=float(r.mean()),
                    rms=float(rms),
                    normalised=float(normalised),
                )
            )
        return tuple(out)


@one_blas_thread()
def compare(
    run: Run,
    model: Model | None = None,
    estimates: Prior | None = None,
    progress: Progress = quiet,
    learnt: Learnt | None = None,
) -> Comparison:
    """Measured against predicted deviations.

    Args:
        model: Machine and effects; None for the ordinary geometric model of the machine.
        estimates: Of the model's parameters, from an earlier run; then nothing but where the
            standard stands is learnt from this one. None fits the whole model to this run.
        progress: Told of the tests.
        learnt: What a model file kept of the fit to this very run; None where it was another run.

    Raises:
        NotEnoughData: So few touches that nothing can be said.
    """
    run = with_commanded(without_copies(run))
    model = model or ordinary_model(run.touches.chain)
    if estimates is None:
        fit = fit_run(run, model)
        u = run.u
    else:
        fit = _predicted(run, model, estimates)
        u = np.sqrt(run.u**2 + machine_variance(run.touches, model, estimates.root, run.u))
    nothing = EffectSet(ResidualSpace.of(fit), np.zeros((int(fit.used.sum()) + len(fit.prior), 0)))
    found = tuple(find_structure(nothing, progress))
    return Comparison(
        fit=fit,
        is_prediction=estimates is not None,
        u=u,
        structure=found,
        where=regions(fit),
        geometry=learnt_geometry(fit, estimates),
        # a machine that is no longer its model's is no mistake in the description
        repeatability=repeatability(fit),
        promise=promise(fit) if estimates is None else None,
        faults=description_faults(fit if estimates is None else fit_run(run, model), progress),
        remarks=remarks(fit),
        learnt=None if learnt is None else learnt.again(run, model),
    )


def _predicted(run: Run, model: Model, estimates: Prior) -> Fit:
    """Set-ups fitted to a run, the machine as estimated before.

    No touch is called a gross error unless it is one beside the uncertainty of the prediction.
    """
    learnt = fit_run(run, model, estimates)
    known = Prior(estimates.mean, np.zeros_like(estimates.root))
    gross = replace(learnt.gross, too_many=False)
    everything = replace(run, split=np.full(len(run), "", dtype="U5"))
    return fit_run(everything, model, known, gross=gross)
