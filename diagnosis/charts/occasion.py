"""What one measurement of a machine says of the quantities that are charted.

Every run is fitted by itself with the ordinary geometric model, backlash of every axis that was
reached from both sides, and effects that the user names. Of the geometry those quantities are taken
that do not depend on where peaks happen to lie: lines and zeros of rotary axes, squareness, scales,
and of arms zeros and lengths. Three figures stand for all the rest: the volumetric error over the
poses that the first run probed, the error of touches held out, and the error of a run as the
machine of the first one predicts it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from enum import Enum

import numpy as np

from matstd.diagnosis.accuracy import probed_volume
from matstd.diagnosis.files import SavedModel
from matstd.diagnosis.fit import Fit, Prior, fit_run
from matstd.diagnosis.geometry import Estimate, Quantity, geometry_rows
from matstd.diagnosis.policy import POLICY
from matstd.twin.compute import Progress, one_blas_thread, silent
from matstd.twin.frames import Array
from matstd.twin.library import is_visible, kinds, ordinary_model, parse_effect
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, Model
from matstd.twin.numbers import rms_length
from matstd.twin.record import Run, Touches, with_commanded, without_copies

POSES = 200  # poses of the volumetric error; the same of every run, so that they choose no change


class Overall(Enum):
    """Charted figures that are no quantity of the geometry."""

    BACKLASH = "backlash"
    EFFECT = "size of an effect"
    VOLUME = "volumetric error"
    FIRST = "error with the machine of the first run"
    PROOF = "error of held-out touches"


GEOMETRY = (
    Quantity.ROTARY_LINE,
    Quantity.ROTARY_ZERO,
    Quantity.SQUARENESS,
    Quantity.SCALE,
    Quantity.JOINT_ZERO,
    Quantity.LINK_LENGTH,
    Quantity.JOINT_OFFSET,
    Quantity.LINK_TWIST,
)
"""Quantities of the geometry that are charted."""


@dataclass(frozen=True, slots=True)
class Charted:
    """What a chart is of."""

    quantity: Quantity | Overall
    symbol: str = ""  # its ISO 230-1 name, or the effect; "" of an overall figure
    axes: tuple[str, ...] = ()  # the axis, or the two of a squareness, the reference first
    unit: str = "mm"  # "mm", "rad", or "1" for a scale


@dataclass(frozen=True, slots=True, eq=False)
class Occasion:
    """One measurement of a machine."""

    name: str
    date: datetime | None  # when; None where it is not known
    chain: Chain
    standard: str  # stamp of the standard; "" where it is not recorded
    prints: tuple[str, ...]  # fingerprints of the measurements
    touches: int
    values: Mapping[Charted, Estimate]  # what it determines
    # least and largest coordinates of the touched points by feature, (2, 3)
    places: Mapping[str, Array] = field(default_factory=dict)


@one_blas_thread()
def occasions_of_runs(
    runs: Mapping[str, Run], added: Sequence[str] = (), progress: Progress = silent
) -> list[Occasion]:
    """Every run fitted by itself, the first one first.

    Args:
        runs: By name, in the order of time.
        added: Names of effects that are fitted beside the geometry.

    Raises:
        NotEnoughData: A run with too few touches.
        UnknownEffect: A name that means nothing here.
    """
    out: list[Occasion] = []
    first: Fit | None = None
    for number, (name, run) in enumerate(runs.items()):
        progress("runs", number, len(runs))
        run = with_commanded(without_copies(run))
        fit = fit_run(run, _model(run.touches, added))
        if first is None:
            first = fit
            poses = probed_volume(run, POSES, np.random.default_rng(0))
        out.append(
            Occasion(
                name=name,
                date=run.date,
                chain=run.touches.chain,
                standard=run.standard,
                prints=run.fingerprints,
                touches=len(run),
                values=dict(_values(fit, first, poses, added)),
                places=_places(run.touches),
            )
        )
    return out


def occasions_of_models(models: Mapping[str, SavedModel]) -> list[Occasion]:
    """What saved models state as determined; those that state nothing have no values."""
    return [
        Occasion(
            name=name,
            date=saved.source.began,
            chain=saved.model.chain,
            standard=saved.source.standard,
            prints=tuple(saved.source.learnt_from[-1:]),
            touches=saved.source.touches,
            values=dict(_stated(saved)),
        )
        for name, saved in models.items()
    ]


def _model(touches: Touches, added: Sequence[str]) -> Model:
    """Geometry, then reversals, then what the user names."""
    chain = touches.chain
    proposed = (e for k in kinds() if k.word == "backlash" for e in k.propose(touches))
    named = [parse_effect(name, chain) for name in added]
    known = {effect.name for effect in named}
    reversals = [e for e in proposed if is_visible(e, touches) and e.name not in known]
    return Model(chain, (*ordinary_model(chain).effects, *reversals, *named))


def _values(
    fit: Fit, first: Fit, poses: Touches, added: Sequence[str]
) -> Iterator[tuple[Charted, Estimate]]:
    """Everything that a run determines of what is charted."""
    for row in geometry_rows(fit):
        if row.quantity in GEOMETRY and row.is_determined:
            yield Charted(row.quantity, row.symbol, row.axes, row.unit), row.estimate
    yield from _sizes(fit, added)
    yield Charted(Overall.VOLUME), volumetric_error(fit, poses)
    if fit is not first:
        yield Charted(Overall.FIRST), _of_rms(*_left_by(first, fit))
    held_out = int(fit.test_rows.sum()) or int(fit.used.sum())
    yield Charted(Overall.PROOF), _of_rms(fit.test_rms, held_out)


def _sizes(fit: Fit, added: Sequence[str]) -> Iterator[tuple[Charted, Estimate]]:
    """Reversals and named effects, as far as the run and not the expectation decides them."""
    u = np.sqrt(np.diag(fit.covariance))
    for k, (effect, parameter) in enumerate(fit.model.parameters):
        is_named = effect.name in {parse_effect(n, fit.model.chain).name for n in added}
        if effect.kind != "backlash" and not is_named:
            continue
        if u[k] * POLICY.determined_ratio < parameter.sd:
            yield _charted(effect, fit.names[k], parameter.unit), Estimate(fit.theta[k], u[k])


def _charted(effect: Effect, name: str, unit: str) -> Charted:
    """A size of an effect."""
    kind = Overall.BACKLASH if effect.kind == "backlash" else Overall.EFFECT
    return Charted(kind, name, (), unit)


def volumetric_error(fit: Fit, poses: Touches) -> Estimate:
    """Volumetric error over some poses, the standard aligned, rms, mm.

    ``V^2 = mean |f|^2`` with f the displacement of the ball relative to the standard by the
    geometry of the model, less the rigid motion that fits it best; ``u^2 = g C g`` with
    ``g = dV/dtheta``.
    """
    geometry = ordinary_model(poses.chain)
    count = len(geometry.parameters)
    columns = geometry.relative_columns(poses)  # (N, 3, P)
    arm = poses.point - poses.point.mean(axis=0)
    turns = np.stack([np.cross(axis, arm) for axis in np.eye(3)], axis=2)
    rigid = np.concatenate([np.tile(np.eye(3), (len(arm), 1, 1)), turns], axis=2).reshape(-1, 6)
    basis, strength, _ = np.linalg.svd(rigid, full_matrices=False)
    basis = basis[:, strength > 1e-9 * strength[0]]
    flat = columns.reshape(-1, count)
    flat = flat - basis @ (basis.T @ flat)
    f = flat @ fit.theta[:count]
    size = rms_length(f.reshape(-1, 3))
    g = (flat.T @ f) / (len(arm) * max(size, 1e-12))
    return Estimate(size, float(np.sqrt(g @ fit.covariance[:count, :count] @ g)))


def _left_by(first: Fit, fit: Fit) -> tuple[float, int]:
    """Error of a run, its set-ups fitted, by the machine of the first; with its touches."""
    count = len(first.model.parameters)
    known = Prior(first.theta[:count], np.zeros((count, count)))
    run = replace(fit.run, split=np.full(len(fit.run), "", dtype="U5"))
    predicted = fit_run(run, first.model, known, gross=replace(fit.gross, too_many=False))
    return predicted.rms, int(predicted.used.sum())


def _of_rms(value: float, count: int) -> Estimate:
    """A root mean square of so many independent errors: ``u = rms / sqrt(2 n)``."""
    return Estimate(value, value / float(np.sqrt(2.0 * max(count, 1))))


def _places(touches: Touches) -> dict[str, Array]:
    """Least and largest coordinates of the points on every named feature."""
    names = [str(name) for name in dict.fromkeys(touches.feature) if name]
    points = {name: touches.point[touches.feature == name] for name in names}
    return {name: np.stack([p.min(axis=0), p.max(axis=0)]) for name, p in points.items()}


def _stated(saved: SavedModel) -> Iterator[tuple[Charted, Estimate]]:
    """Quantities, reversals and the held-out error of a saved model."""
    for one in saved.determined:
        if one.quantity in GEOMETRY:
            yield Charted(one.quantity, one.symbol, one.axes, one.unit), one.estimate
    u = np.linalg.norm(saved.estimates.root, axis=1)
    names = saved.model.names
    for k, (effect, parameter) in enumerate(saved.model.parameters):
        if effect.kind == "backlash" and u[k] * POLICY.determined_ratio < parameter.sd:
            value = float(saved.estimates.mean[k])
            yield _charted(effect, names[k], parameter.unit), Estimate(value, float(u[k]))
    if saved.source.promise is not None:
        error = saved.source.promise.same
        yield Charted(Overall.PROOF), _of_rms(error, saved.source.touches)
