"""Designs the families that may be built, and chooses the one that wins."""

from dataclasses import dataclass, replace

from matstd.artefact.body import Standard, check
from matstd.artefact.hidden import hidden_power
from matstd.artefact.hidden import touched as single
from matstd.artefact.place.family import Family, FamilyFigures, chosen_family, flat_pads
from matstd.artefact.place.identifying import (
    Identifying,
    Site,
    identifying_choices,
    left_unknown,
    with_proof,
)
from matstd.artefact.place.proving import proving_touches, touches_on_faces
from matstd.artefact.place.proving_balls import balls_alone, proving_on_balls
from matstd.artefact.place.wavy_choice import PROOF_POSES, wavy_choice
from matstd.artefact.place.wavy_proof import (
    PLACES_PER_TOUCH,
    SCAN_POSES,
    measurement_on,
    showing_on_body,
    showing_table_poses,
)
from matstd.artefact.price import prices_of
from matstd.artefact.reach import Requests, joined, spread_poses
from matstd.twin.errors import NotBuildable, NotReachable
from matstd.twin.frames import Array
from matstd.twin.numbers import rms


@dataclass(frozen=True, eq=False)
class Built:
    """One family, designed: its standard with the touches that identify, and those that prove."""

    family: Family
    found: Identifying
    proof: Requests
    scan_poses: Array  # at which a wavy face is scanned, (K, R), rad; none of other families

    @property
    def standard(self) -> Standard:
        """Its body."""
        return self.found.standard

    @property
    def requests(self) -> Requests:
        """The touches that identify."""
        return self.found.tried[self.found.chosen]


def built_family(site: Site) -> tuple[Built, tuple[FamilyFigures, ...]]:
    """The family that the project names, or the one that wins; and the figures of all tried.

    Raises:
        NotBuildable: The named family cannot be built, or none can.
        NotReachable: The machine reaches too few touches.
    """
    wanted = site.options.family
    if wanted != "auto":
        one = _built(site, Family(wanted))
        return one, (_figures(site, one),)
    made, figures, refusals = dict[Family, Built](), list[FamilyFigures](), []
    for family in Family:
        try:
            made[family] = _built(site, family, made.get(Family.FACES))
        except (NotBuildable, NotReachable) as error:
            refusals.append(error)
            figures.append(FamilyFigures(family, refused=str(error)))
            continue
        figures.append(_figures(site, made[family]))
    if not made:
        raise refusals[0]
    chosen = chosen_family(tuple(figures), site.options.goal, site.best_balls)
    return made[chosen], tuple(figures)


def _built(site: Site, family: Family, like: Built | None = None) -> Built:
    """One family designed; flat pads stand where `like` has faces."""
    if family in (Family.WAVY, Family.BALLS):
        return _showing(site, family)
    count, reach = site.options.choice.proof, site.criterion.reach
    if family is Family.FACES:
        found, on_faces = _with_faces(site)
    else:
        found = _flat(site, like)
        on_faces = touches_on_faces(reach, found.standard, found.poses, count)
    here = site.criterion.on(found.standard)
    chosen = found.tried[found.chosen]
    proof = proving_touches(here, found.standard, on_faces, chosen, count)
    return Built(family, found, proof, found.poses[:0])


def _showing(site: Site, family: Family) -> Built:
    """Balls alone, or round one wavy face: touched where that shows most."""
    criterion, options, count = site.criterion, site.options, site.options.choice.proof
    found = wavy_choice(site) if family is Family.WAVY else balls_alone(site)
    body, poses = found.standard, found.poses
    here = criterion.plain.on(body)
    given = single(found.tried[found.chosen], criterion.noise)
    if family is Family.WAVY:
        poses = showing_table_poses(here, body, given, poses, site.effects_at, PROOF_POSES)
        tried = touches_on_faces(criterion.reach, body, poses, count, PLACES_PER_TOUCH)
    else:
        tried = proving_on_balls(criterion, body, spread_poses(poses, PROOF_POSES), count)
    proof = showing_on_body(here, body, tried, given, site.effects_at, count)
    scans = family is Family.WAVY and options.scan is not None
    return Built(family, found, proof, poses[: SCAN_POSES if scans else 0])


def _flat(site: Site, like: Built | None) -> Identifying:
    """Flat pads in the places of small faces."""
    found = _with_faces(site)[0] if like is None else like.found
    found = replace(found, standard=flat_pads(found.standard))
    check(found.standard, site.brief.blank.limits)
    return found


def _with_faces(site: Site) -> tuple[Identifying, Requests]:
    """Balls with small faces between them, and the possible touches on the faces."""
    options, bodies = site.options, site.bodies
    if bodies is None:
        raise NotBuildable(f"{options.patches} small faces do not fit")
    found = identifying_choices(site, bodies)
    return with_proof(found, site.criterion.reach, options.choice.proof)


def _figures(site: Site, one: Built) -> FamilyFigures:
    """What a designed family gives."""
    criterion, body = site.criterion, one.standard
    scan = site.options.scan if one.family is Family.WAVY else None
    touches = joined([one.requests, one.proof])
    measured = measurement_on(criterion, body, touches, scan, one.scan_poses)
    power = hidden_power(criterion.plain.on(body), measured, site.effects_at)
    least = power.effects[power.worst]
    left = left_unknown(criterion, body, one.requests)
    once = 0.0 if scan is None else sum(scan.minutes(face) for face in body.patches)
    prices = [price.total for price in prices_of(body)]
    return FamilyFigures(
        family=one.family,
        rms_user=rms(left),
        worst_user=float(left.max()),
        signal=power.least_signal,
        power=float(power.power[power.worst]),
        least=(least.is_bump, least.width, least.direction),
        touches=len(touches),
        scan_minutes=once * len(one.scan_poses),
        price=min(prices, key=lambda price: price.value, default=None),
        scan_points=0 if scan is None else sum(scan.points(face) for face in body.patches),
    )
