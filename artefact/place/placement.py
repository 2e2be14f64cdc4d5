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

from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from artefact.body import DatumSphere, Standard
from artefact.compare import (
    Power,
    Rival,
    compare,
    evaluated,
    prior_rms,
    proof_power,
    random_lots,
    task_normals,
)
from artefact.layout import Blank, with_spheres
from artefact.place.body_choice import BodyChoice, body_choice
from artefact.place.proving import proving_touches, telling_touches, touches_on_faces
from artefact.place.room import check_blank
from artefact.reach import Mask, ProbeReach, Requests, joined
from artefact.worth import (
    BallPlaces,
    Criterion,
    CriterionOptions,
    TouchOptions,
    Visibility,
    ball_places,
    chosen_poses,
    chosen_touches_on,
    criterion_for,
    error_shares,
    parameter_symbols,
    random_touches,
    table_poses,
    touches_to_choose_from,
    visibility,
)
from information.criteria import whitened
from information.selection import Certificate
from sensitivity.first_order import Workspace
from sensitivity.population import Population
from twin.compute import Progress, silent
from twin.errors import NotBuildable, NotReachable
from twin.frames import Array
from twin.units import UM

__all__ = ["Placement", "PlacementOptions", "design_standard"]

_FREE, _BASES = 480, 3  # free touches that judge what is visible, at least; sets of balls, at most
_AGAIN, _LITTLE = 3, 1.02  # draws of other faces while they cost more than 1 % in µm
_NEXT_TO_NOTHING = 1.005  # times what the balls alone leave


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
        power: How surely the proving touches find a model wrong over the task: along the normals
            of surfaces as steep as the faces, anywhere in the probed volume.
        power_in_volume: The same of a model that is wrong there in whatever direction.
        power_of_balls: That of as many further touches on the balls, which are no proof: what is
            wrong with a ball went into the model.
        power_exact: As `power`, were the places of the faces known exactly.
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
    power_in_volume: Power
    power_of_balls: Power
    power_exact: Power
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
    check_blank(blank.base, reach)
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
    bodies = body_choice(places, all_poses, options.patches, options.sites, rng)
    progress("placement", 2, 6)
    library = _effects(criterion, max(choice.touches, _FREE), rng)
    rivals, unreachable = compare(criterion, places, all_poses, blank, choice, library, rng)
    progress("placement", 4, 6)
    bases = _bases(criterion.plain, rivals, places, all_poses, options)
    first = _identifying_best(criterion, bodies, bases, options)
    found = _rearranged(criterion, bodies, places, first, bases[0].value, all_poses, choice)
    found, on_faces = _with_proof([found, first], reach, choice.proof)
    on_body, here = criterion.on(found.standard), criterion.on(replace(found.standard, patches=()))
    proof, powers = _proving(on_body, found, on_faces, choice.proof, library, rng)
    requests, tried = found.tried[found.chosen], found.tried
    standard = _with_shares(criterion, found.standard, proof)
    progress("placement", 5, 6)
    lots = random_lots(tried, len(requests), rng)
    own = evaluated(f"standard {options.name}", here, requests, lots, library, len(tried), standard)
    progress("placement", 6, 6)
    return Placement(
        standard=standard,
        requests=requests,
        proof=proof,
        criterion=criterion,
        prior_rms=prior_rms(criterion),
        rivals=(own, *rivals),
        certificate=found.nearness,
        power=powers[0],
        power_in_volume=powers[1],
        power_of_balls=powers[2],
        power_exact=powers[3],
        unreachable=unreachable,
    )


@dataclass(frozen=True, eq=False)
class _Base:
    """Balls to build on, touches on them, and the value of these where no face is in the way."""

    balls: tuple[DatumSphere, ...]
    touches: Requests
    value: float


@dataclass(frozen=True, eq=False)
class _Identifying:
    """A standard with the touches that identify by it: those that can be made, the choice."""

    standard: Standard
    poses: Array
    tried: Requests
    chosen: Mask
    nearness: Certificate


def _bases(
    criterion: Criterion,
    rivals: tuple[Rival, ...],
    places: BallPlaces,
    all_poses: Array,
    options: PlacementOptions,
) -> list[_Base]:
    """Those of the rivals, the best first, or as many balls as find room."""
    of_balls = [
        r
        for r in rivals
        if r.body is not None and not r.body.patches and len(r.body.spheres) <= options.balls
    ]
    if of_balls:
        return [
            _Base(r.body.spheres, r.touches, r.value)
            for r in sorted(of_balls, key=lambda r: r.value)
            if r.body is not None
        ]
    balls = places.best(options.balls, options.choice.touches)
    body = with_spheres(places.blank, [b.centre for b in balls])
    poses = chosen_poses(criterion.on(body), body, body.spheres, all_poses, options.choice)
    tried = touches_to_choose_from(
        criterion.reach, body, body.spheres, poses, options.choice.touches
    )
    return [_Base(body.spheres, tried, 0.0)]


def _identifying_best(
    criterion: Criterion, bodies: BodyChoice, bases: list[_Base], options: PlacementOptions
) -> _Identifying:
    """The best of a few draws of faces; one where they cost little or none compares."""
    best, alone = _identifying(criterion, bodies, bases, options), bases[0].value
    for _ in range(_AGAIN if alone else 0):
        if best.nearness.value <= _LITTLE * alone:
            break
        with suppress(NotBuildable, NotReachable):  # what the first draw found stays
            again = _identifying(criterion, bodies, bases, options)
            best = min(best, again, key=lambda found: found.nearness.value)
    return best


def _identifying(
    criterion: Criterion, bodies: BodyChoice, bases: list[_Base], options: PlacementOptions
) -> _Identifying:
    """The best balls that leave room for the faces, and the touches that identify by them.

    Where every ball of a base stays nothing better is looked for; where some had to go, the next
    base is tried as well.
    """
    best: _Identifying | None = None
    choice, refused = options.choice, NotReachable("no ball")
    for base in bases[:_BASES]:
        poses = np.unique(base.touches.rotary, axis=0)
        standard = bodies.standard(
            options.name, options.serial, base.balls, base.touches, options.patches, choice.proof
        )
        here, reach = criterion.on(replace(standard, patches=())), criterion.reach
        tried = touches_to_choose_from(reach, standard, standard.spheres, poses, choice.touches)
        try:
            chosen, nearness = chosen_touches_on(here, tried, choice)
        except NotReachable as error:
            refused = error
            continue
        if best is None or nearness.value < best.nearness.value:
            best = _Identifying(
                standard=standard, poses=poses, tried=tried, chosen=chosen, nearness=nearness
            )
        if len(standard.spheres) == len(base.balls):
            break
    if best is None:
        raise refused
    return best


def _rearranged(
    criterion: Criterion,
    bodies: BodyChoice,
    places: BallPlaces,
    found: _Identifying,
    alone: float,
    all_poses: Array,
    choice: TouchOptions,
) -> _Identifying:
    """The same faces with balls and table poses chosen anew beside them, if that tells more.

    Nothing is tried where the faces cost next to nothing of what the balls alone are worth.
    """
    if found.nearness.value <= _NEXT_TO_NOTHING * alone:
        return found
    standard = bodies.rearranged(found.standard, places, choice.touches)
    if standard is None:
        return found
    bare = replace(standard, patches=())
    plain, here = criterion.plain.on(bare), criterion.on(bare)
    try:
        poses = chosen_poses(plain, standard, standard.spheres, all_poses, choice)
        tried = touches_to_choose_from(
            here.reach, standard, standard.spheres, poses, choice.touches
        )
        chosen, nearness = chosen_touches_on(here, tried, choice)
    except NotReachable:
        return found
    if nearness.value >= found.nearness.value:
        return found
    return _Identifying(
        standard=standard, poses=poses, tried=tried, chosen=chosen, nearness=nearness
    )


def _with_proof(
    choices: list[_Identifying], reach: ProbeReach, count: int
) -> tuple[_Identifying, Requests]:
    """The first choice on whose faces touches enough can be made, or the last; those touches."""
    for found in choices:
        on_faces = touches_on_faces(reach, found.standard, found.poses, count)
        if len(on_faces) >= count:
            break
    return found, on_faces


def _proving(
    criterion: Criterion,
    found: _Identifying,
    on_faces: Requests,
    count: int,
    library: Visibility,
    rng: np.random.Generator,
) -> tuple[Requests, tuple[Power, Power, Power, Power]]:
    """Touches that prove, and their powers.

    Over the task, in the volume, that of the balls, and over the task were the faces known exactly.
    """
    standard, requests = found.standard, found.tried[found.chosen]
    proof = proving_touches(criterion, standard, on_faces, requests, count)
    others = found.tried[~found.chosen]
    others = others if len(others) >= count else found.tried  # the same ones once more
    more = telling_touches(criterion, others, requests, min(count, len(others)))
    effects, normals = library.effects, task_normals(criterion, proof, rng)
    known = replace(criterion.calibration, patch=0.0, patch_tilt=0.0)
    exact = replace(criterion, calibration=known)
    return proof, (
        proof_power(criterion, requests, proof, effects, rng, normals),
        proof_power(criterion, requests, proof, effects, rng),
        proof_power(criterion, requests, more, effects, rng),
        proof_power(exact, requests, proof, effects, rng, normals),
    )


def _effects(criterion: Criterion, count: int, rng: np.random.Generator) -> Visibility:
    """Effects of the library that touches taken at random could show."""
    free = random_touches(criterion.reach, criterion.volume, criterion.rotary, count, rng)
    return visibility(criterion, free)


def _with_shares(criterion: Criterion, standard: Standard, requests: Requests) -> Standard:
    """The standard with the errors that each patch is for."""
    touches = criterion.reach.touches(requests)
    W = whitened(criterion.model.columns(touches), criterion.model.prior_sd, criterion.noise)
    shares = error_shares(W, requests.feature.tolist(), parameter_symbols(criterion.model))
    patches = tuple(replace(p, errors=shares.get(p.name, ())) for p in standard.patches)
    return replace(standard, patches=patches)
