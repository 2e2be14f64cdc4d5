"""The data of the live view of a run, packed for the page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from matstd.diagnosis.fit import Fit, file_unit, inner_unit
from matstd.diagnosis.reduced import Board, Matrices, Switch
from matstd.diagnosis.residual import variables
from matstd.report.effects import effect_title
from matstd.report.laws import LawCurve
from matstd.report.live import TREE, packed
from matstd.report.numbers import capital, pose_word, unit_words
from matstd.report.run_view.touched_bodies import touched_bodies
from matstd.report.style import axis_of
from matstd.twin.frames import Array
from matstd.twin.library import kinds
from matstd.twin.record import Run, Touches
from matstd.twin.units import UM
from matstd.twin.words import in_own_unit

CORNER_STEP = 0.02  # of the corners of bodies, mm; larger ones are coarser

LONG_RUN = 4000
"""Touches from which less is kept of each: fewer columns to plot, residuals at one noise."""

MOST_COLUMNS, FEWER_COLUMNS = 40, 10  # recorded columns that can be plotted; of a long run


@dataclass(frozen=True, slots=True)
class Findings:
    """What the report says of a run, for its live view."""

    title: str  # name of the run
    # held-out error without geometry, mm; None where it is not known
    set_up_alone: float | None = None
    sizes: Mapping[str, str] = field(default_factory=dict)  # of found effects by name
    remains: str = ""  # what remains with everything that was found; empty for nothing to say
    # triangles of what was probed, (T, 3, 3), mm; None where only its touches are known
    body: Array | None = None
    # whether a model predicts the machine, and the run places the standard alone
    is_prediction: bool = False


def run_data(
    board: Board, findings: Findings, curves: Mapping[str, Sequence[LawCurve]] | None = None
) -> TREE:
    """Data of `run_page.js`; `curves` are those of laws by name, one for every variable."""
    fit = board.fit
    alone = None if findings.set_up_alone is None else findings.set_up_alone / UM
    return {
        "title": findings.title,
        "remains": in_own_unit(findings.remains),
        "unit": in_own_unit("µm"),
        "noise": float(np.median(fit.run.u)) / UM,
        "foundNoise": float(np.median(fit.u)) / UM,
        "setUpAlone": alone,
        "touches": _touches(fit),
        "columns": _columns(fit.run.touches),
        "curves": [_curve(law, c) for law, own in (curves or {}).items() for c in own],
        "isPrediction": findings.is_prediction,
        "body": _body(fit.run.touches, findings.body),
        "switches": [_switch(s, findings.sizes.get(s.effect.name, "")) for s in board.switches],
        "estimate": packed(board.estimate, "f8"),
        "known": [
            {"on": sorted(on), "fitted": known[0] / UM, "heldOut": known[1] / UM}
            for on, known in board.known.items()
        ],
        "reduced": _reduced(board),
        "residuals": _residuals(board),
    }


def _touches(fit: Fit) -> TREE:
    """What is known of every touch."""
    t, run = fit.run.touches, fit.run
    features, feature = np.unique(t.feature, return_inverse=True)
    state = np.where(fit.gross.rows | fit.gross_test_rows, 1, np.where(run.split == "test", 2, 0))
    # the largest number of two bytes stands for no group, as the script of the page knows
    group = np.full(len(run), 65535)
    names = _group_names(fit)
    if not fit.test_rows.any():
        rows = np.flatnonzero(fit.used)
        for k, members in enumerate(fit.groups):
            group[rows[members]] = k
    else:
        poses, label = np.unique(np.column_stack([t.setup, t.pose]), axis=0, return_inverse=True)
        group[fit.test_rows] = label.reshape(-1)[fit.test_rows]
        names = [_pose_name(t, int(s), int(p)) for s, p in poses]
    return {
        "count": len(run),
        "point": packed(np.nan_to_num(t.point), "f4", unit="mm"),
        "normal": packed(np.nan_to_num(t.normal), "f4"),
        "measured": packed(run.deviation / UM, "f4", unit="µm"),
        "u": packed(run.u / UM, "f4", unit="µm"),
        "line": packed(run.line, "u4"),
        **_programmed(run),
        "feature": packed(feature.reshape(-1), "u2"),
        "features": [str(name) for name in features],
        "setup": packed(t.setup, "u2"),
        "setups": [s.name for s in t.setups],
        "pose": packed(t.pose, "i4"),
        "poseWord": pose_word(t),
        "state": packed(state, "u1"),
        "group": packed(group, "u2"),
        "groups": names,
        "isSpread": bool(np.ptp(t.point, axis=0).max(initial=0.0) > 0.0),
    }


def _programmed(run: Run) -> TREE:
    """Where each touch stands in its program; nothing where no row says."""
    names, which = np.unique(run.program, return_inverse=True)
    if not np.any(run.program != ""):
        return {"programs": []}
    return {
        "programs": [str(name) for name in names],
        "program": packed(which.reshape(-1), "u1" if len(names) < 256 else "u2"),
        "number": packed(run.touch, "u4"),
        "programLine": packed(run.program_line, "u4"),
    }


def _group_names(fit: Fit) -> list[str]:
    """Of what is left out together: a pose, or a stretch of touches."""
    t, rows = fit.run.touches, np.flatnonzero(fit.used)
    out = []
    for members in fit.groups:
        own = rows[members]
        poses = {(int(s), int(p)) for s, p in zip(t.setup[own], t.pose[own], strict=True)}
        is_whole = len(poses) == 1 and len(fit.groups) > len(np.unique(t.pose[rows]))
        if len(poses) == 1 and not is_whole:
            out.append(_pose_name(t, *poses.pop()))
        else:
            lines = fit.run.line[own]
            out.append(f"lines {lines.min()}–{lines.max()}")
    repeated = len(set(out)) < len(out)
    return [f"{name} ({k + 1})" for k, name in enumerate(out)] if repeated else out


def _pose_name(touches: Touches, setup: int, pose: int) -> str:
    alone = len(touches.setups) == 1
    return f"{pose}" if alone else f"{touches.setups[setup].name} {pose}"


def _columns(touches: Touches) -> list[TREE]:
    """Recorded columns that vary, time first."""
    known = dict(variables(touches))
    known |= {name: values for name, values in touches.value.items() if np.ptp(values) > 0.0}
    names = sorted(known, key=lambda name: name != "time_s")
    most = MOST_COLUMNS if len(touches) < LONG_RUN else FEWER_COLUMNS
    out = []
    for name in names[:most]:
        label, values = axis_of(name, known[name])
        out.append(packed(values, "f4", name=capital(label)))
    if "time_s" not in known:
        order = packed(np.arange(1, len(touches) + 1), "f4", name="Number of the touch")
        out.insert(0, order)
    return out


def _curve(law: str, curve: LawCurve) -> TREE:
    """A law over a variable; levers in the unit of the residual over that of the carrier."""
    return {
        "law": law,
        "title": f"{curve.title} over {curve.label.partition(' in ')[0]}",
        "carrier": f"{curve.title} in {in_own_unit(curve.unit)}",
        "label": capital(curve.label),
        "x": packed(curve.x, "f4"),
        "value": packed(curve.value, "f4"),
        "u": packed(curve.u, "f4"),
        "touchX": packed(curve.touch_x, "f4"),
        "touchValue": packed(curve.touch_value, "f4"),
        "lever": packed(curve.lever * curve.scale / UM, "f4"),
    }


def _body(touches: Touches, known: Array | None) -> TREE | None:
    """What was touched, in grains that suit its size; None where nothing can be drawn."""
    parts = touched_bodies(touches) if known is None else [known]
    if not parts:
        return None
    corners = np.concatenate(parts).reshape(-1)
    grain = max(CORNER_STEP, float(np.abs(corners).max()) / 32000.0)
    return packed(corners, "i2", unit="mm", grain=grain)


def _switch(one: Switch, size: str) -> TREE:
    """An effect as it is shown and mixed."""
    kind = next((k for k in kinds() if k.word == one.effect.kind), None)
    inner: TREE | None = None
    if one.inner is not None:
        suffix, factor = inner_unit(one.inner)
        is_ratio = bool(one.values[0] > 0.0 and one.values[-1] > 4.0 * one.values[0])
        inner = {
            "name": _inner_words(one.inner.name),
            "unit": {"_min": "min", "_s": "s", "_mm": "mm", "_deg": "°"}.get(suffix, ""),
            "values": packed(one.values / factor, "f8"),
            "isRatio": is_ratio,
            "present": one.present,
        }
    return {
        "name": one.effect.name,
        "title": capital(effect_title(one.effect)),
        "formula": kind.formula if kind is not None else "",
        "size": in_own_unit(size),
        "isFound": one.is_found,
        "alike": list(one.alike),
        "isFixed": one.is_fixed,
        "amounts": []
        if one.is_fixed
        else [
            _amount(p.name, p.unit, float(sd))
            for p, sd in zip(one.effect.parameters, one.sd, strict=True)
        ],
        "stored": one.columns.shape[1],
        "inner": inner,
        "mixes": packed(one.mixes, "f8"),
    }


def _inner_words(name: str) -> str:
    return {"tau": "time constant"}.get(name, name.replace("_", " "))


def _amount(name: str, unit: str, sd: float) -> TREE:
    """A linear parameter: one prior standard deviation of it in the unit that is shown."""
    suffix, factor = file_unit(unit)
    return {"name": name, "unit": in_own_unit(unit_words(suffix)), "sd": sd / factor}


def _triangle(matrices: Array) -> Array:
    """Upper triangles, row by row, of symmetric matrices (..., K, K)."""
    upper = np.triu_indices(matrices.shape[-1])
    return np.ascontiguousarray(matrices[..., upper[0], upper[1]])


_DIGITS = ("f6", "f6", "f4", "f4", "f4")
"""Numbers of groups left out, by the order of their term: each is a tenth of the last or less, and
the six digits of a held-out error follow from differences of them."""


def _matrices(one: Matrices, order: int = 0) -> TREE:
    """Matrices, or a term of their series; those that are errors in µm for mm."""
    return {
        "G": packed(_triangle(one.G), "f8"),
        "H1": packed(_triangle(one.H1) / UM**2, "f8"),
        "H2": packed(_triangle(one.H2), "f8"),
        "H3": packed(_triangle(one.H3) / UM**2, "f8"),
        "F": packed(_triangle(one.F), _DIGITS[order] if order < len(_DIGITS) else "f3"),
        "tested": packed(_triangle(one.tested) / UM**2, "f8"),
        "freedom": one.freedom,
        "newRun": one.new_run / UM**2,
    }


def _reduced(board: Board) -> TREE:
    """What the solver takes."""
    known = board.reduced
    # where the series reaches to the stated noise, it serves the first pass as well
    is_within = known.span[0] <= 1.0 <= known.span[1]
    return {
        "size": len(board.estimate) + 1,
        "count": known.count,
        "weight": known.weight,
        "first": None if is_within else _matrices(known.first),
        "terms": [_matrices(term, order) for order, term in enumerate(known.terms)],
        "span": list(known.span),
        "isTested": known.is_tested,
        "groupSizes": [] if known.is_tested else [len(g) for g in board.fit.groups],
    }


def _residuals(board: Board) -> TREE:
    """Residual columns of all touches at the noise of the last fit, and what the first one's adds.

    The difference is small: two bytes a number serve it.
    """
    last, first = board.fit.noise.factor, board.errors(()).s
    columns = board.residuals(last).T / UM
    change = None
    if len(board.fit.run) < LONG_RUN and abs(np.log(first / last)) > 1e-3:
        change = [_small(c) for c in board.residuals(first).T / UM - columns]
    return {"last": last, "first": first, "columns": packed(columns, "f4"), "change": change}


def _small(values: Array) -> TREE:
    largest = float(np.abs(values).max(initial=0.0))
    return packed(values, "i2", grain=largest / 32000.0 or 1.0)
