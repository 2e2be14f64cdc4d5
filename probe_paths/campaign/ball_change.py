"""Changes of the probe, from the same touches on one ball before and after a campaign.

Each touch is compared with itself, so that the errors of the machine there cancel:

    gap_after - gap_before = n . c + r

with c the displacement of the ball and r the growth of the probe's effective radius: four unknowns
from eight touches, by least squares. Displacements of ball, table and spindle are not separated.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise
from typing import NamedTuple, get_args, get_type_hints

import numpy as np

from matstd.artefact.body import Standard, fitted_sphere
from matstd.probe_paths.campaign.evaluation import ball_centres
from matstd.probe_paths.control import LogPart
from matstd.probe_paths.language import Dialect
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import Array, apply, inverse, unit
from matstd.twin.machine import Chain
from matstd.twin.units import HOUR, UM

COVERAGE = 2.0  # coverage factor of a significant change

_UNKNOWNS = 4
_EXCESS_SCATTER = 3.0  # times the stated noise in what the four numbers leave over


@dataclass(frozen=True, eq=False)
class BallChange:
    """Changes between two measurements of a ball."""

    ball: str
    before: datetime  # time of the first measurement
    after: datetime  # time of the second
    touches: int
    centre: Array  # by how much its centre has moved, table frame, (3,), mm
    radius: float  # by how much the effective radius of the probe has grown, mm
    u: Array  # standard uncertainties of the four, (4,), mm
    # what four numbers do not explain, rms of one touch, mm; of a ball moved and a radius changed
    # alone it is the noise of a touch
    scatter: float
    is_odd: bool  # it is far beyond the uncertainty that was stated for a touch

    @property
    def size(self) -> float:
        """The larger of both changes, mm."""
        return max(float(np.linalg.norm(self.centre)), abs(self.radius))

    @property
    def is_seen(self) -> bool:
        """Whether anything has changed by more than its expanded uncertainty."""
        return bool(np.any(np.abs([*self.centre, self.radius]) > COVERAGE * self.u))

    @property
    def hours(self) -> float:
        """Between the two."""
        return (self.after - self.before).total_seconds() / HOUR


def ball_changes(
    parts: Sequence[LogPart],
    standard: Standard,
    chain: Chain,
    u: float,
    dialect: Dialect | None = None,
) -> list[BallChange]:
    """Changes from each measurement of a ball to the next one of the same program.

    Args:
        u: Standard uncertainty of one touch, mm; a larger scatter counts instead.

    Raises:
        BadFile: A ball that the standard does not have.
    """
    looks = sorted((p for p in parts if p.is_ball), key=lambda p: (p.program, p.begin))
    return [
        _change(one, other, standard, chain, u, dialect)
        for one, other in pairwise(looks)
        if one.program == other.program and one.begin < other.begin
    ]


def _change(
    one: LogPart,
    other: LogPart,
    standard: Standard,
    chain: Chain,
    u: float,
    dialect: Dialect | None,
) -> BallChange:
    _, rows, again = np.intersect1d(one.number, other.number, return_indices=True)
    where = f"program {other.program} at {other.begin}"
    found = set(one.feature[rows].tolist()) | set(other.feature[again].tolist())
    standard = one.heading.touched(standard)
    names = list(standard.features)
    balls = {sphere.name: sphere for sphere in standard.spheres}
    name = names[min(found) - 1] if len(found) == 1 and 0 < min(found) <= len(names) else ""
    if len(rows) < _UNKNOWNS + 1 or name not in balls:
        common = f"{len(rows)} touches in common with {one.begin} on features {sorted(found)}"
        raise BadFile(
            other.path, where, common, f"{_UNKNOWNS + 1} at least, on one ball of {standard.name}"
        )
    before, after = ball_centres(one, chain, dialect)[rows], ball_centres(other, chain, dialect)
    around = one.heading.setup.T_table_artefact
    middle = fitted_sphere(before, apply(around, balls[name].centre[None])[0]).centre
    way = before - middle
    normal = unit(way)
    grown = np.linalg.norm(after[again] - middle, axis=1) - np.linalg.norm(way, axis=1)
    A = np.column_stack([normal, np.ones(len(rows))])
    solved, _, rank, _ = np.linalg.lstsq(A, grown, rcond=1e-3)
    if rank < _UNKNOWNS:
        found_all = f"{len(rows)} touches on one side of {name}"
        raise BadFile(other.path, where, found_all, "touches all round it")
    left = grown - A @ solved
    # a difference of two touches has twice the variance of one
    scatter = float(np.sqrt(left @ left / (len(rows) - _UNKNOWNS) / 2.0))
    inverse = np.linalg.inv(A.T @ A)
    return BallChange(
        ball=name,
        before=one.begin,
        after=other.begin,
        touches=len(rows),
        centre=solved[:3],
        radius=float(solved[3]),
        u=np.sqrt(2.0 * np.diag(inverse)) * max(u, scatter),
        scatter=scatter,
        is_odd=scatter > _EXCESS_SCATTER * u,
    )


def read_heights(part: LogPart, standard: Standard, chain: Chain) -> dict[str, float]:
    """Gap of a commissioning touch by each meaning of Z (`Dialect.result_height`), mm.

    One touch from above settles which Z a control returns: with the wrong meaning the gap is the
    whole length of the probe.
    """
    ball = list(standard.features.values())[int(part.feature[0]) - 1]
    beside = {}
    for meaning in get_args(get_type_hints(Dialect)["result_height"]):
        believed = inverse(part.heading.setup.T_table_artefact)
        centre = apply(believed, ball_centres(part, chain, Dialect(result_height=meaning)))
        foot = ball.project(centre)
        gap = np.einsum("ni,ni->n", ball.normal(foot), centre - ball.point(foot)) - part.radius
        beside[meaning] = float(gap[0])
    return beside


class EffectiveRadius(NamedTuple):
    """Effective radius of the probe on a calibrated ball."""

    begin: datetime
    excess: float  # over the radius that the control has calibrated, mm
    u: float  # its standard uncertainty, with that of the ball, mm


def effective_radii(
    parts: Sequence[LogPart], chain: Chain, u: float, dialect: Dialect | None = None
) -> list[EffectiveRadius]:
    """Effective radii of the probe by the ball of the workshop, in the order of time.

    A sphere is fitted to the ball centres of each log: its radius is that of the ball and the
    effective one of the probe. The machine errors over the ball remain in it.

    Args:
        u: Standard uncertainty of one touch, mm.
    """
    out = []
    for part in sorted(parts, key=lambda part: part.begin):
        ball = part.heading.ball
        if ball is None or len(part.number) < _UNKNOWNS + 1:
            continue
        centres = ball_centres(part, chain, dialect)
        around = part.heading.setup.T_table_artefact
        believed = apply(around, ball.sphere(around).centre[None])[0]
        sphere = fitted_sphere(centres, believed)
        spread = float(np.sqrt(sphere.cofactor[3, 3]))
        excess = sphere.radius - ball.radius - part.radius
        out.append(EffectiveRadius(part.begin, excess, float(np.hypot(spread * u, ball.u))))
    return out


def check_changes(changes: Sequence[BallChange], limit: float) -> None:
    """Refuse measurements between which the probe has changed.

    Args:
        limit: Largest accepted motion of the ball, or change of its radius, mm.

    Raises:
        DesignError: A change beyond the limit that is no noise.
    """
    for change in changes:
        if change.is_seen and change.size > limit:
            raise DesignError(
                f"ball {change.ball} between {change.before} and {change.after}: it has moved or "
                f"the probe has changed by {change.size / UM:.1f} µm, expected {limit / UM:g} µm "
                "at most: measure again, or state a larger limit"
            )
