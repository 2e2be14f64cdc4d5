"""One large wavy face with balls round it: its size and its waves, by what they show.

Every wave that cutter, probe and blank allow is judged by the signal of the unmodelled effect
that it shows least (`matstd.artefact.hidden`). The largest face comes first that leaves
the balls enough: they identify, and may cost no more than 2 % against balls alone. Asked for by
name it may cost 5 %, for the goal to prove 35 %: balls in the rim of a large face see little of the
middle.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.hidden import hidden_power, measured_together
from matstd.artefact.hidden import touched as single
from matstd.artefact.layout import Blank, Wave, wavy_face, with_spheres
from matstd.artefact.place.body_choice import balls_beside
from matstd.artefact.place.family import MOST_COST
from matstd.artefact.place.identifying import Identifying, Site, identifying_on, left_unknown
from matstd.artefact.place.wavy_proof import (
    PLACES_PER_TOUCH,
    SCAN_POSES,
    measurement_on,
    showing_on_body,
    showing_table_poses,
)
from matstd.artefact.reach import Requests, spread_poses
from matstd.artefact.worth import Criterion, ball_places, each_at, face_grid
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.frames import Array
from matstd.twin.numbers import rms
from matstd.twin.units import DEG

_RIMS = (42.0, 46.0, 50.0, 55.0, 60.0, 65.0, 70.0, 80.0, 90.0, 100.0, 110.0)
"""Mm between the sides of face and base, the largest face first: a post with its fillet and room
for a cutter needs 42 mm. Half as many are tried: the smaller a face, the less it costs."""

_ASKED_COST = 1.05
"""Largest error over the workspace of a wavy face that is asked for by name, relative to the best
balls alone: a larger face shows more of what no model has."""

_PROVING_COST = 1.35
"""The same where the goal is to prove: a face over nearly the whole base shows 1.4 times as much as
49 balls in every direction, and balls in its rim leave a third more unknown."""

_LEAST_HALF = 40.0  # mm, of a face that is worth its block
_WAVELENGTHS, _FLATNESS = (45.0, 60.0, 80.0), (0.0, 0.9)
_TURNS = (0.0, 22.5 * DEG)  # against x, tried for the best wave, which is turned by 45 degrees
_EVERY_NTH_TOUCH = 3  # every third identifying touch stands for all while waves are compared
PROOF_POSES = 6  # table poses of the touches on the face


def wavy_choice(site: Site) -> Identifying:
    """The wavy face that shows most, and the balls and touches that identify beside it.

    Where every size costs more than it may the cheapest is returned; where families are compared
    it is left aside.

    Raises:
        NotBuildable: No wavy face fits beside as many balls.
    """
    options, criterion, blank = site.options, site.criterion, site.places.blank
    wave, rng = _best_wave(site), np.random.default_rng(site.brief.seed)
    most = _PROVING_COST if options.goal == "prove" else _ASKED_COST
    most = MOST_COST if options.family == "auto" else most
    sizes, best, least, refused = list(_sizes(blank)), None, np.inf, "no balls fit"
    first, last = 0, len(sizes)  # the largest that costs no more than it may is within
    while first < last:
        middle = (first + last) // 2
        face = wavy_face("FF1", blank, replace(wave, half_size=sizes[middle]))
        cost = np.inf
        try:
            ring = ball_places(criterion.plain, blank, site.all_poses, rng, [face])
            made = balls_beside([face], options.balls, ring, options.choice.touches)
            if made is not None:
                made = replace(made, name=options.name, serial=options.serial)
                found = identifying_on(site, made)
                left = left_unknown(criterion, made, found.tried[found.chosen])
                cost = rms(left) / site.best_balls if np.isfinite(site.best_balls) else 1.0
        except NotReachable as error:
            refused = str(error)
        if cost <= most or cost < least:
            best, least = found, cost
        first, last = (first, middle) if cost <= most else (middle + 1, last)
    if best is None:
        raise NotBuildable(f"no wavy face beside {len(site.bases[0].balls)} balls: {refused}")
    return best


def _sizes(blank: Blank) -> Iterator[tuple[float, float]]:
    """Half sides of faces on a blank, the largest first."""
    for rim in _RIMS:
        a, b = (half - rim for half in blank.base.half_size)
        if min(a, b) >= _LEAST_HALF:
            yield round(a, 1), round(b, 1)


def _best_wave(site: Site) -> Wave:
    """The wave of which the least visible effect shows most."""
    blank, base = site.places.blank, site.bases[0]
    size = min(_sizes(blank), key=lambda half: half[0] * half[1], default=None)
    if size is None:
        raise NotBuildable(
            f"no wavy face of {2 * _LEAST_HALF:g} mm fits on a base of "
            f"{2 * blank.base.half_size[0]:g} x {2 * blank.base.half_size[1]:g} mm beside balls"
        )
    poses, given = spread_poses(site.all_poses, PROOF_POSES), base.touches[::_EVERY_NTH_TOUCH]
    bare = replace(with_spheres(blank, []), spheres=base.balls)

    def signal_of(wave: Wave) -> float:
        body = replace(bare, patches=(wavy_face("FF1", blank, wave),))
        return _signal(site, body, given, poses)

    best, most, refused = _strongest(_waves(size, blank), signal_of)
    if best is None:
        raise NotBuildable(f"no wavy face: {refused}")
    turned, more, _ = _strongest([replace(best, turn=turn) for turn in _TURNS], signal_of)
    return turned if turned is not None and more > most else best


def _strongest(
    waves: Iterable[Wave], signal_of: Callable[[Wave], float]
) -> tuple[Wave | None, float, str]:
    """The wave with the largest signal, that signal, and why another cannot be built."""
    best, most, refused = None, 0.0, ""
    for wave in waves:
        try:
            signal = signal_of(wave)
        except (NotBuildable, NotReachable) as error:
            refused = str(error)
            continue
        if signal > most:
            best, most = wave, signal
    return best, most, refused


def _signal(site: Site, body: Standard, given: Requests, poses: Array) -> float:
    """Signal of the effect that a body with one wavy face shows least.

    Args:
        given: Touches on its balls.

    Raises:
        NotReachable: Too few places of the face can be touched.
    """
    criterion, options, effects_at = site.criterion, site.options, site.effects_at
    here, count = criterion.plain.on(body), options.choice.proof
    on_balls = single(given, criterion.noise)
    tried = _some_touches(criterion, body.patches[0], poses, count)
    touches = showing_on_body(here, body, tried, on_balls, effects_at, count)
    # the balls are those of another body, some of them within the face
    alone = replace(body, spheres=())
    at = poses[:0]
    if options.scan is not None:
        at = showing_table_poses(here, alone, on_balls, poses, effects_at, SCAN_POSES)
    lots = [on_balls, measurement_on(criterion, alone, touches, options.scan, at)]
    return hidden_power(here, measured_together(lots), effects_at, False).least_signal


def _waves(size: tuple[float, float], blank: Blank) -> Iterator[Wave]:
    for wavelength in _WAVELENGTHS:
        for flatness in _FLATNESS:
            yield Wave(
                middle=(0.0, 0.0),
                half_size=size,
                wavelength=wavelength,
                slope=blank.limits.max_slope,
                flatness=flatness,
            )


def _some_touches(criterion: Criterion, face: FreeformPatch, poses: Array, count: int) -> Requests:
    """Possible touches all over a face, each at one of the poses."""
    grid = face_grid(face.half_size, int(np.ceil(np.sqrt(PLACES_PER_TOUCH * count))))
    turns = poses[np.arange(len(grid)) % len(poses)]
    one = each_at(face, grid, poses[:1])
    touches = replace(one, rotary=turns)
    return touches[criterion.reach.is_reachable(touches)]
