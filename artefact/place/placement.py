"""Chooses balls, freeform faces, table poses and touches by their information.

Balls on posts identify: a ball whose centre is known to a few tenths of a micrometre determines a
machine better than any other feature, so all identifying touches are on balls. Freeform faces
prove: they have the slopes, curvatures and table poses of real work, their touches are held out
from the identification, and a wrong model shows on them (`matstd.artefact.compare`).

Candidate faces and balls are spread over the blank; every touch that is possible on them at some
table poses is a row ``n^T J`` times the shape functions of the expected errors. Balls, then faces
between them, then poses, then single touches are chosen such that the tool point is predicted best
over the user's poses, and the finished body is checked against every limit.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.brief import Brief, Goal
from matstd.artefact.compare import (
    Power,
    Rival,
    compared,
    evaluate_rival,
    prior_rms,
    proof_power,
    random_lots,
    task_normals,
)
from matstd.artefact.feasibility import check_blank
from matstd.artefact.place.body_choice import BodyChoice, body_choice
from matstd.artefact.place.families import Built, built_family
from matstd.artefact.place.family import Family, FamilyFigures
from matstd.artefact.place.identifying import Site
from matstd.artefact.place.proving import informative_touches
from matstd.artefact.reach import Requests, joined
from matstd.artefact.worth import (
    BallPlaces,
    Criterion,
    Visibility,
    ball_places,
    criterion_for,
    poses_within,
    random_touches,
    visibility,
    with_error_shares,
)
from matstd.information.selection import Certificate
from matstd.twin.compute import Progress, silent
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array

_MIN_FREE_TOUCHES = 480  # smallest number of free touches that decide which effects are visible


@dataclass(frozen=True, eq=False)
class Placement:
    """A standard and the touches it was designed for."""

    standard: Standard  # checked against every limit; every patch names the errors that it reveals
    requests: Requests  # the touches that identify, all on balls
    # the touches that prove, on faces or on balls of their own, at the same table poses
    proof: Requests
    criterion: Criterion  # that chose them, on no body
    # expected deviation of the tool point before any touch, rms, mm: over the probed volume, over
    # the user's workspace
    prior_rms: tuple[float, float]
    # this standard first, then other artefacts at as many identifying touches
    rivals: tuple[Rival, ...]
    # how near the identifying touches are to the best choice among all possible ones at these table
    # poses and quotas
    certificate: Certificate
    # of the proving touches to detect a wrong model along normals with the slopes of the faces,
    # anywhere in the probed volume
    power: Power
    power_in_volume: Power  # the same for errors in any direction
    # of as many further touches on the balls, which are no proof: errors of a ball went into the
    # model
    power_of_balls: Power
    power_exact: Power  # as `power`, with exactly known positions of the faces
    scan_poses: Array  # table poses at which the face is scanned, (K, R), rad; none without a scan
    family: Family = Family.FACES  # features that prove
    families: tuple[FamilyFigures, ...] = ()  # figures of every family that was tried
    goal: Goal = "prove"  # what decided between them
    # artefacts that are not compared: too few touches are possible on them
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
    brief: Brief, rng: np.random.Generator, progress: Progress = silent, poses: Array | None = None
) -> Placement:
    """Design a standard for a machine.

    Args:
        brief: Machine, probe, set-up, blank, expected errors, and what is wanted.
        progress: Called with stage, done and total.
        poses: Candidate table poses, (K, R), rad, from `feasibility`; None for a grid over the
            workspace.

    Raises:
        NotBuildable: The blank is larger than the table, or no choice of faces and balls meets
            every limit; the message names what binds.
        NotReachable: The machine reaches too few touches on the standard.
    """
    progress("candidates", 0, 1)
    reach, blank, options = brief.reach, brief.blank, brief.options
    choice = options.choice
    check_blank(blank.base, reach)
    criterion = _criterion_of(brief, rng)
    all_poses = poses_within(reach.chain, brief.rotary, choice.poses) if poses is None else poses
    places = ball_places(criterion.plain, blank, all_poses, rng)
    bodies = _small_faces(brief, places, all_poses, rng)
    progress("artefacts of balls", 0, 1)
    library = _visible_effects(criterion, max(choice.touches, _MIN_FREE_TOUCHES), rng)
    choices = criterion, places, all_poses, blank, choice, library, rng, options.balls
    with compared(*choices) as others:
        site = Site(
            brief=brief,
            criterion=criterion,
            places=places,
            bodies=bodies,
            rivals=others.of_balls,
            all_poses=all_poses,
            progress=progress,
        )
        built, families = built_family(site)
        requests, proof, tried = built.requests, built.proof, built.found.tried
        here = criterion.on(replace(built.standard, patches=()))
        powers = _powers(criterion.on(built.standard), built, choice.proof, library, rng)
        standard = with_error_shares(criterion, built.standard, proof)
        progress("other artefacts", 0, 1)
        lots = random_lots(tried, len(requests), rng)
        own = evaluate_rival(
            f"standard {options.name}", here, requests, lots, library, len(tried), standard
        )
        rivals = own, *others.all()
    return Placement(
        standard=standard,
        requests=requests,
        proof=proof,
        criterion=criterion,
        prior_rms=prior_rms(criterion),
        rivals=rivals,
        certificate=built.found.nearness,
        power=powers[0],
        power_in_volume=powers[1],
        power_of_balls=powers[2],
        power_exact=powers[3],
        scan_poses=built.scan_poses,
        family=built.family,
        families=families,
        goal=options.goal,
        unreachable=others.unreachable,
    )


def _criterion_of(brief: Brief, rng: np.random.Generator) -> Criterion:
    """What touches are chosen for, on no body."""
    options = brief.options
    return criterion_for(
        brief.reach,
        brief.population.expected("w"),
        brief.blank,
        brief.workspace,
        options.noise,
        rng,
        options.criterion,
        options.choice.touches,
        brief.population,
    )


def _small_faces(
    brief: Brief, places: BallPlaces, all_poses: Array, rng: np.random.Generator
) -> BodyChoice | None:
    """Candidate small faces; None where the project wants none, or where none of `auto` fit."""
    options = brief.options
    if options.family in (Family.WAVY, Family.BALLS):
        return None
    try:
        return body_choice(places, all_poses, options.patches, options.sites, rng)
    except NotBuildable:
        if options.family != "auto":
            raise
        return None


def _powers(
    criterion: Criterion, built: Built, count: int, library: Visibility, rng: np.random.Generator
) -> tuple[Power, Power, Power, Power]:
    """Powers of the proof: over the task, in the volume, of the balls, with exactly known faces."""
    proof, requests, tried = built.proof, built.requests, built.found.tried
    others = tried[~built.found.chosen]
    others = others if len(others) >= count else tried  # too few others: repeat the same ones
    more = informative_touches(criterion, others, requests, min(count, len(others)))
    effects, normals = library.effects, task_normals(criterion, proof, rng)
    known = replace(criterion.calibration, patch=0.0, patch_tilt=0.0)
    if not built.standard.patches:  # the balls that prove are as those that identify
        known = replace(known, ball=0.0)
    exact = replace(criterion, calibration=known)
    return (
        proof_power(criterion, requests, proof, effects, rng, normals),
        proof_power(criterion, requests, proof, effects, rng),
        proof_power(criterion, requests, more, effects, rng),
        proof_power(exact, requests, proof, effects, rng, normals),
    )


def _visible_effects(criterion: Criterion, count: int, rng: np.random.Generator) -> Visibility:
    """Effects of the library that random touches could show."""
    free = random_touches(criterion.reach, criterion.volume, criterion.rotary, count, rng)
    return visibility(criterion, free)
