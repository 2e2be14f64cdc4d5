"""Data and markup of what moves on the page of a design."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from matstd.artefact.body import Standard
from matstd.artefact.brief import Brief
from matstd.artefact.compare import Rival
from matstd.artefact.place import Placement
from matstd.artefact.reach import Requests
from matstd.artefact.worth import Criterion
from matstd.diagnosis.accuracy import prove, seen_from
from matstd.diagnosis.fit import Fit
from matstd.probe_paths.plan import TouchPlan
from matstd.report.layout import LiveView
from matstd.report.live import TREE, packed, scripted, style
from matstd.report.machine import machine_data, probe_body, standard_bodies
from matstd.twin.frames import Array, inverse
from matstd.twin.machine import linear_motion, table_to_tool
from matstd.twin.model import Effect
from matstd.twin.record import Setup, at_poses
from matstd.twin.sampling import grid_points
from matstd.twin.units import DEG, UM

COUNTS = (11, 11, 9)  # places along the three linear axes
_SHARES = (0.5, 0.15, 0.85)  # of the range of every rotary axis, at which the field is worked out


@dataclass(frozen=True, eq=False)
class ErrorField:
    """Error vectors over a grid of linear readings, at some rotary readings."""

    axes: tuple[str, ...]  # names of the three linear axes
    at: tuple[Array, ...]  # readings of each, ascending, mm
    # readings of the rotary axes by name, for every field, rad
    rotary: tuple[dict[str, float], ...]
    # (F, n1, n2, n3, 3) along the motion of each axis, mm; nan outside the user's volume
    before: Array
    after: Array  # not predicted by the identified model, the same shape, mm


def error_field(
    brief: Brief, believed: Setup, truth: Sequence[tuple[Effect, Array]], fit: Fit
) -> ErrorField | None:
    """The field over the user's workspace; None on a machine without three linear axes."""
    workspace, chain = brief.workspace, brief.chain
    axes = chain.linear_axes
    if len(axes) != len(COUNTS):
        return None
    at = tuple(np.linspace(*workspace.limit(a), n) for a, n in zip(axes, COUNTS, strict=True))
    grid = grid_points(*at)
    rotary = []
    before: list[Array] = []
    after: list[Array] = []
    for share in _SHARES if chain.rotary_axes else _SHARES[:1]:
        q = np.zeros((len(grid), len(chain.axes)))
        q[:, chain.linear_columns] = grid
        stands = {}
        for name in chain.rotary_axes:
            low, high = workspace.limit(name)
            stands[name] = float(low + share * (high - low))
            q[:, chain.axis_index(name)] = stands[name]
        proof = prove(
            fit, truth, brief.setup, seen_from(at_poses(chain, q, brief.probe.length), believed)
        )
        # shown as what each linear axis would have to move, so that its own error fills one picture
        to_table = believed.T_table_artefact[:3, :3]
        outside = ~workspace.in_volume(q)
        for vectors, into in ((proof.before, before), (proof.after, after)):
            along = linear_motion(chain, q, vectors @ to_table.T)[:, chain.linear_columns]
            along[outside] = np.nan
            into.append(along.reshape(*COUNTS, 3))
        rotary.append(stands)
    return ErrorField(
        axes=axes, at=at, rotary=tuple(rotary), before=np.array(before), after=np.array(after)
    )


class Feature(NamedTuple):
    """A ball or a face, or the rest of the body."""

    name: str  # empty for the rest
    kind: str  # `ball`, `face` or `body`
    colour: str  # as `#rrggbb`
    corners: Array  # artefact frame, (T, 3, 3), mm


def features_of(standard: Standard) -> list[Feature]:
    """All bodies of a standard: the rest first, then balls, then faces."""
    balls = {s.name for s in standard.spheres}
    return [
        Feature(name, "body" if not name else "ball" if name in balls else "face", colour, corners)
        for name, colour, corners in standard_bodies(standard)
    ]


def feature_shares(
    criterion: Criterion, standard: Standard, touches: Requests
) -> Mapping[str, float]:
    """Predicted error of the tool point without the touches on each feature, rms, mm.

    Args:
        criterion: That chose the touches, on no body.
        touches: Those that identify.

    Returns:
        By feature, over the user's workspace; with all touches under the empty name.
    """
    on_body = criterion.on(standard)
    tip = on_body.tip_user
    # the mean over the poses of trace(G Sigma G^T) is that of Sigma times one moment of G
    moment = np.einsum("mip,miq->pq", tip, tip, optimize=True) / len(tip)
    out = {}
    for name in ["", *np.unique(touches.feature).tolist()]:
        left = touches[np.flatnonzero(touches.feature != name)]
        out[name] = float(np.sqrt(np.sum(on_body.after(left).covariance * moment)))
    return out


CORNER_STEP = 0.05  # of the corners of bodies, mm


@dataclass(frozen=True, eq=False)
class DesignScene:
    """What the page of a design shows that moves."""

    brief: Brief
    placement: Placement
    plan: TouchPlan  # touches of the first clamping and probe, in their order
    minutes: Mapping[str, float]  # on the machine, by the name of the artefact
    field: ErrorField | None  # errors of the first simulated machine; None where there is no volume


def design_live(scene: DesignScene) -> LiveView:
    """What moves, for the page."""
    environment = Environment(
        loader=PackageLoader("matstd.report.design_view"),
        autoescape=True,
        undefined=StrictUndefined,
    )
    place = environment.get_template("design.html").render(has_field=scene.field is not None)
    own = environment.get_template("design.css").render()
    return LiveView(
        style=style() + Markup("<style>\n{}</style>").format(Markup(own)),
        place=Markup(place),
        script=scripted("design_page", _data(scene)),
    )


def _data(scene: DesignScene) -> TREE:
    brief, placement = scene.brief, scene.placement
    standard, chain = placement.standard, brief.chain
    features = features_of(standard)
    without = feature_shares(placement.criterion, standard, placement.requests)
    return {
        **machine_data(chain),
        "length": brief.probe.length,
        "features": [
            {
                "name": one.name,
                "kind": one.kind,
                "colour": one.colour,
                "corners": _corners(one.corners),
                "touches": int(np.sum(scene.plan.feature == one.name)),
                "errors": [
                    {"name": e.name, "share": e.share}
                    for patch in standard.patches
                    if patch.name == one.name
                    for e in patch.errors[:5]
                ],
                "without_um": without[one.name] / UM if one.name in without and one.name else None,
            }
            for one in features
        ],
        "with_all_um": without[""] / UM,
        "touches": _touches(scene.plan),
        "probe": _corners(probe_body(scene.plan.probe).corners),
        "rivals": [
            _rival(rival, scene.minutes.get(rival.name, np.nan), k == 0)
            for k, rival in enumerate(placement.rivals)
        ],
        "field": None if scene.field is None else _field(scene.field),
    }


def _corners(corners: Array) -> TREE:
    return packed(corners.reshape(-1, 3), "i2", grain=CORNER_STEP, unit="mm")


def _touches(plan: TouchPlan) -> TREE:
    """Touches in their order, with the pose of the tool seen from the standard."""
    T = inverse(plan.setup.T_table_artefact) @ table_to_tool(plan.chain, plan.contact)
    names = list(dict.fromkeys(plan.feature.tolist()))
    rotary = plan.chain.rotary_columns
    return {
        "point": packed(plan.point, "f4", unit="mm"),
        "normal": packed(plan.normal, "f4"),
        # columns of three, as the scripts take them
        "tool": packed(np.swapaxes(T[:, :3], 1, 2), "f4"),
        "names": names,
        "feature": packed([names.index(name) for name in plan.feature.tolist()], "u2"),
        "visit": packed(plan.visit, "u2"),
        "is_anchor": packed(plan.request < 0, "u1"),
        "rotary": packed(plan.contact[:, rotary] / DEG, "f4", unit="°"),
        "rotary_names": list(plan.chain.rotary_axes),
    }


def _rival(rival: Rival, minutes: float, is_own: bool) -> TREE:
    """One artefact with its figures; the body of the standard itself is there already."""
    bodies = [] if is_own or rival.body is None else features_of(rival.body)
    return {
        "name": rival.name,
        "is_own": is_own,
        "user_um": rival.rms_user / UM,
        "volume_um": rival.rms / UM,
        "estimable": rival.estimable,
        "visible": rival.visible,
        "could_be_visible": rival.could_be_visible,
        "minutes": float(minutes) if np.isfinite(minutes) else None,
        "bodies": [{"colour": b.colour, "corners": _corners(b.corners)} for b in bodies],
        "point": packed(_places(rival.touches), "f4", unit="mm"),
    }


def _places(touches: Requests) -> Array:
    return np.unique(np.round(touches.point, 3), axis=0)


def _field(field: ErrorField) -> TREE:
    return {
        "axes": list(field.axes),
        "at": [a.tolist() for a in field.at],
        "rotary": [{k: v / DEG for k, v in one.items()} for one in field.rotary],
        "before": packed(field.before / UM, "f4", unit="µm"),
        "after": packed(field.after / UM, "f4", unit="µm"),
    }
