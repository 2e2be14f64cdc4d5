"""Chooses balls, freeform faces, table poses and touches by what they tell of the machine.

Balls on posts identify: nothing tells more of a machine than a precision ball whose centre is known
to a few tenths of a micrometre, so all identifying touches are made on them. Freeform faces prove:
they have slopes, curvatures and table poses of real work, they are touched beside the balls and
held back from the identification, and a model that is wrong shows on them (`artefact.compare`).

Candidate faces and balls stand all over the blank; every touch that could be made on them at some
table poses is a row ``n^T J`` times the shape functions of the expected errors. Balls, then faces
between them, then poses, then single touches are chosen so that the tool point can be predicted
best over the user's poses, and the finished body is measured against every limit.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from artefact.body import Base, DatumSphere, FreeformPatch, MountingHole, Standard, constraints
from artefact.compare import (
    Power,
    Rival,
    compare,
    evaluated,
    prior_rms,
    proof_power,
    random_lots,
)
from artefact.layout import (
    Blank,
    beside_holes,
    faces_beside,
    faces_fit,
    freeform_faces,
    holes_on,
    least_gap,
    most_side_by_side,
)
from artefact.place.proving import proving_touches
from artefact.reach import ProbeReach, Requests, joined, spread_poses
from artefact.worth import (
    BallPlaces,
    Criterion,
    CriterionOptions,
    TouchOptions,
    ball_places,
    chosen_poses,
    chosen_touches_on,
    criterion_for,
    each_at,
    error_shares,
    face_grid,
    parameter_symbols,
    random_touches,
    table_poses,
    touches_to_choose_from,
    visibility,
)
from information.criteria import whitened
from information.selection import Certificate, best_groups
from sensitivity.first_order import Workspace
from sensitivity.population import Population
from twin.compute import Progress, silent
from twin.errors import NotBuildable, NotReachable
from twin.frames import Array
from twin.record import IntArray
from twin.units import UM

__all__ = ["Placement", "PlacementOptions", "design_standard"]

_FREE = 480  # free touches, at least, by which an effect is judged visible at all
_REBUILDS = 8  # choices of faces tried before giving up
_FEWEST_BALLS = 3  # a set-up has six unknowns, and a ball alone hides every turn about it


@dataclass(frozen=True)
class PlacementOptions:
    """What is designed, how much is tried, and what for.

    Attributes:
        name: Type of the standard.
        serial: Of the piece.
        patches: Number of freeform patches.
        balls: Number of balls, fewer where no more find room.
        sites: Number of random faces to choose from.
        noise: Standard deviation of one touch, mm.
        criterion: What faces, balls, poses and touches are chosen for.
        choice: How many touches at how many table poses.
    """

    name: str = "FFS"
    serial: str = ""
    patches: int = 6
    balls: int = 13
    sites: int = 400
    noise: float = 1.0 * UM
    criterion: CriterionOptions = field(default_factory=lambda: CriterionOptions(potential=0.3))
    choice: TouchOptions = field(default_factory=TouchOptions)


@dataclass(frozen=True, eq=False)
class Placement:
    """A standard and the touches it was designed for.

    Attributes:
        standard: Measured against every limit; every patch names the errors it is for.
        requests: The touches that identify, all on balls.
        proof: The touches that prove, all on freeform faces, at the same table poses.
        criterion: What they were chosen by, on no body.
        prior_rms: Expected deviation of the tool point before any touch, rms, mm: over the probed
            volume, over the user's workspace.
        rivals: This standard first, then other artefacts at as many identifying touches.
        certificate: How near the identifying touches are to the best choice among all that could be
            made on the standard at its table poses and that crowd no pose more.
        power: How surely the proving touches find a model wrong in the probed volume.
        power_of_balls: The same of as many further touches on the balls, which are no proof: what
            is wrong with a ball went into the model.
        unreachable: Artefacts that are not compared: this machine can make no touch on them.
    """

    standard: Standard
    requests: Requests
    proof: Requests
    criterion: Criterion
    prior_rms: tuple[float, float]
    rivals: tuple[Rival, ...]
    certificate: Certificate
    power: Power
    power_of_balls: Power
    unreachable: tuple[str, ...] = ()

    @property
    def own(self) -> Rival:
        """Figures of this standard."""
        return self.rivals[0]

    @property
    def touches(self) -> Requests:
        """All touches: those that identify first."""
        return joined([self.requests, self.proof])


def design_standard(
    reach: ProbeReach,
    blank: Blank,
    workspace: Workspace,
    rng: np.random.Generator,
    population: Population | None = None,
    options: PlacementOptions | None = None,
    progress: Progress = silent,
    poses_to_try: Array | None = None,
) -> Placement:
    """Design a standard for a machine.

    Args:
        reach: Machine, probe, set-up of the standard.
        blank: Blank, datum features, material, limits.
        workspace: Where the user works: its poses are predicted, its rotary limits are those of the
            table poses.
        population: Machines that are expected, with the relations between their errors; None for
            the ordinary ones.
        options: How much is tried and chosen.
        progress: Told what is being done.
        poses_to_try: Table poses to choose from, (K, R), rad; None for a grid over the workspace.

    Raises:
        NotBuildable: The blank is larger than the table, or no choice of faces and balls meets
            every limit; the message names what binds.
        NotReachable: The machine reaches too few touches on the standard.
    """
    options = options or PlacementOptions()
    choice = options.choice
    _check_blank(blank.base, reach)
    population = population or Population(reach.chain)
    criterion = criterion_for(
        reach,
        population.expected("w"),
        blank,
        workspace,
        options.noise,
        rng,
        options.criterion,
        choice.touches,
        population,
    )
    progress("placement", 1, 6)
    all_poses = table_poses(criterion, choice.poses) if poses_to_try is None else poses_to_try
    places = ball_places(criterion.plain, blank, all_poses, rng)
    standard = _standard(criterion.plain, places, blank, all_poses, options, rng)
    progress("placement", 2, 6)
    identifying = replace(standard, patches=())
    here, balls = criterion.on(identifying), standard.spheres
    poses = chosen_poses(criterion.plain.on(identifying), standard, balls, all_poses, choice)
    tried = touches_to_choose_from(reach, standard, balls, poses, choice.touches)
    chosen, nearness = chosen_touches_on(here, tried, choice)
    requests = tried[chosen]
    progress("placement", 3, 6)
    whole = criterion.on(standard)
    on_faces = touches_to_choose_from(reach, standard, standard.patches, poses, choice.proof)
    proof = proving_touches(whole, on_faces, requests, choice.proof)
    more = proving_touches(whole, tried[~chosen], requests, choice.proof)
    standard = _with_shares(criterion, standard, proof)
    progress("placement", 4, 6)
    free = random_touches(
        reach, criterion.volume, criterion.rotary, max(choice.touches, _FREE), rng
    )
    library = visibility(criterion, free)
    lots = random_lots(tried, len(requests), rng)
    own = evaluated(f"standard {options.name}", here, requests, lots, library, len(tried), standard)
    powers = [proof_power(whole, requests, lot, library.effects, rng) for lot in (proof, more)]
    rivals, unreachable = compare(criterion, places, all_poses, poses, blank, choice, library, rng)
    progress("placement", 6, 6)
    return Placement(
        standard=standard,
        requests=requests,
        proof=proof,
        criterion=criterion,
        prior_rms=prior_rms(criterion),
        rivals=(own, *rivals),
        certificate=nearness,
        power=powers[0],
        power_of_balls=powers[1],
        unreachable=unreachable,
    )


def _check_blank(base: Base, reach: ProbeReach) -> None:
    """Refuse a blank whose sides reach beyond the table; its corners may."""
    if max(base.half_size) > reach.table_radius:
        a, b = (2.0 * side for side in base.half_size)
        raise NotBuildable(
            f"a blank of {a:g} x {b:g} mm is larger than the table, diameter "
            f"{2.0 * reach.table_radius:g} mm"
        )


def _standard(
    criterion: Criterion,
    places: BallPlaces,
    blank: Blank,
    poses: Array,
    options: PlacementOptions,
    rng: np.random.Generator,
) -> Standard:
    """Choose balls, and faces between them, until the whole body meets every limit."""
    holes = holes_on(blank)
    faces = freeform_faces(blank, options.patches, options.sites, rng)
    balls = places.best(options.balls, options.choice.touches, beside_holes(places.balls, holes))
    fits = faces_fit(faces, holes, blank.limits)
    few = spread_poses(poses, 20)
    wanted = joined([each_at(p, face_grid(p.half_size, 3)[::2], few) for p in faces])
    wanted = wanted[criterion.reach.is_reachable(wanted)]
    if not len(wanted):
        raise NotReachable(
            f"no face at any of {len(faces)} places can be touched at a table pose with every axis "
            "within its travel"
        )
    W, group = criterion.rows(wanted), wanted.feature.astype(np.int64)
    take = max(4, options.choice.proof // options.patches)
    refused = f"between two of them cutter and probe need {least_gap(blank.limits):g} mm"
    binding: list[str] = []
    for _ in range(_REBUILDS):
        while True:
            free = faces_beside(faces, balls, blank)
            chosen = _side_by_side(criterion, W, group, options.patches, take, fits, free)
            if len(chosen) == options.patches:
                break
            if len(balls) <= _FEWEST_BALLS:
                raise NotBuildable(
                    f"only {len(chosen)} of {options.patches} patches fit on the blank beside "
                    f"{len(balls)} balls; {refused}",
                    fitting=len(chosen),
                )
            balls = balls[:-1]  # the last one chosen tells least
        standard = _put_together([faces[k] for k in chosen], balls, holes, blank, options)
        broken = [c for c in constraints(standard, blank.limits) if c.slack < 0.0]
        if not broken:
            return standard
        refused, binding = str(broken[0]), [c.name for c in broken]
        names = [p.name for p in standard.patches]
        for constraint in broken:
            _blame(fits, constraint.features, names, chosen)
    raise NotBuildable(
        f"no choice of {options.patches} patches meets every limit; {refused}", binding=binding
    )


def _side_by_side(
    criterion: Criterion,
    W: Array,
    group: IntArray,
    count: int,
    take: int,
    fits: NDArray[np.bool_],
    free: NDArray[np.bool_],
) -> list[int]:
    """The faces that are worth most; if their neighbours run out, begun from some that all fit."""
    rows = free[group]
    W, group = W[rows], group[rows]
    chosen = best_groups(criterion.objective, W, group, count, take, apart=fits)
    if len(chosen) < count:
        touched = np.isin(np.arange(len(fits)), group)
        begin = most_side_by_side(fits & touched & touched[:, None], count)
        if len(begin) > len(chosen) and touched[begin].all():
            chosen = best_groups(criterion.objective, W, group, count, take, None, fits, begin)
    return chosen


def _put_together(
    faces: list[FreeformPatch],
    balls: list[DatumSphere],
    holes: tuple[MountingHole, ...],
    blank: Blank,
    options: PlacementOptions,
) -> Standard:
    """A standard of some faces and balls, each kind named around its middle."""
    faces = sorted(faces, key=lambda p: _azimuth(p.T_artefact_patch[:3, 3]))
    balls = sorted(balls, key=lambda b: _azimuth(b.centre))
    return Standard(
        name=options.name,
        serial=options.serial,
        material=blank.material,
        base=blank.base,
        core=None,
        patches=tuple(replace(p, name=f"FF{i}") for i, p in enumerate(faces, 1)),
        spheres=tuple(replace(b, name=f"SPH{i}") for i, b in enumerate(balls, 1)),
        holes=holes,
        blank_height=blank.height,
    )


def _azimuth(place: Array) -> float:
    return float(np.arctan2(place[1], place[0]))


def _blame(
    fits: NDArray[np.bool_], features: tuple[str, ...], names: list[str], chosen: list[int]
) -> None:
    """Keep the faces that violate a limit from being chosen so again."""
    guilty = [chosen[names.index(name)] for name in features if name in names]
    if len(guilty) == 2 and guilty[0] != guilty[1]:
        fits[guilty[0], guilty[1]] = fits[guilty[1], guilty[0]] = False
    else:
        out = guilty or [chosen[-1]]
        fits[out, :] = fits[:, out] = False


def _with_shares(criterion: Criterion, standard: Standard, requests: Requests) -> Standard:
    """The standard with the errors that each patch is for."""
    touches = criterion.reach.touches(requests)
    W = whitened(criterion.model.columns(touches), criterion.model.prior_sd, criterion.noise)
    shares = error_shares(W, requests.feature.tolist(), parameter_symbols(criterion.model))
    patches = tuple(replace(p, errors=shares.get(p.name, ())) for p in standard.patches)
    return replace(standard, patches=patches)
