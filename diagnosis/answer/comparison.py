"""Measurements against a model: residuals, what they vary with, and where the model fails."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import chdtrc

from matstd.diagnosis.accuracy import (
    Promise,
    Repeatability,
    machine_root,
    promise,
    repeatability,
)
from matstd.diagnosis.evidence import EffectSet, Progress, ResidualSpace, quiet
from matstd.diagnosis.faults import DescriptionFault, description_faults
from matstd.diagnosis.fit import Fit, Learnt, Prior, fit_run
from matstd.diagnosis.geometry import LearntGeometry, learnt_geometry
from matstd.diagnosis.policy import POLICY
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

LARGER_THAN_STATED = 1.1
"""Chi-square per degree of freedom from which a residual is larger than stated, beyond chance: a
noise is seldom stated to 5 %."""


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
        shared: What of it the touches share, root of a covariance, (N, K), mm; K = 0 without a
            prediction.
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
    shared: Array
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
        return float(z @ z) / self._dof

    @property
    def _dof(self) -> float:
        return max(float(self.counted.sum()) - self.fit.solution.effective_parameters, 1e-9)

    @cached_property
    def chance(self) -> float:
        """Probability of a squared residual at least as large by the stated uncertainties.

        That of a prediction is shared by touches: ``z^T z`` is then a sum of squares with the
        eigenvalues of the correlation of z as weights, here g times chi-square of as many degrees
        of freedom as give its mean and variance (Satterthwaite).
        """
        shared = (self.shared / self.u[:, None])[self.counted]
        each = np.einsum("nk,nk->n", shared, shared)
        squared = np.sum((1.0 - each) ** 2 + 2.0 * (1.0 - each) * each)
        squared += np.sum((shared.T @ shared) ** 2)
        dof = self._dof * len(each) / float(squared)
        return float(chdtrc(dof, self.chi2_ratio * dof))

    @property
    def is_larger(self) -> bool:
        """Whether the residual is larger than its stated uncertainty, beyond chance."""
        return self.chance < POLICY.false_alarm and self.chi2_ratio > LARGER_THAN_STATED

    @property
    def is_noise(self) -> bool:
        """Whether nothing shows that the model fails: no pattern, no region, no larger residual."""
        return not (self.structure or self.where or self.is_larger)

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
        fit, shared = fit_run(run, model), np.zeros((len(run), 0))
    else:
        fit = _predicted(run, model, estimates)
        shared = machine_root(run.touches, model, estimates.root, run.u)
    nothing = EffectSet(ResidualSpace.of(fit), np.zeros((int(fit.used.sum()) + len(fit.prior), 0)))
    found = tuple(find_structure(nothing, progress))
    return Comparison(
        fit=fit,
        is_prediction=estimates is not None,
        u=np.sqrt(run.u**2 + np.einsum("nk,nk->n", shared, shared)),
        shared=shared,
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
