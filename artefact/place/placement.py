"""Chooses patches, table poses and touches by what they tell of the machine.

Candidate sites with random shapes stand all over the blank; every touch that could be made on them
at some table poses is a row ``n^T J`` times the shape functions of the expected errors. Sites, then
poses, then single touches are chosen so that the tool point can be predicted best over the
user's poses (`information.selection.touch_selection`), and the finished body is measured against
every limit.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from artefact.body import Base, Standard, constraints
from artefact.compare import Rival, compare, evaluated, prior_rms, random_lots
from artefact.layout import (
    Blank,
    Site,
    most_side_by_side,
    neighbour_gaps,
    patch_of_site,
    random_sites,
    standard_from_sites,
)
from artefact.place.shaping import with_optimised_shapes
from artefact.reach import ProbeReach, Requests, joined, spread_poses
from artefact.worth import (
    Criterion,
    CriterionOptions,
    TouchOptions,
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
_REBUILDS = 8  # choices of sites tried before giving up


@dataclass(frozen=True)
class PlacementOptions:
    """What is designed, how much is tried, and what for.

    Attributes:
        name: Type of the standard.
        serial: Of the piece.
        patches: Number of freeform patches.
        sites: Number of random sites to choose from.
        noise: Standard deviation of one touch, mm.
        criterion: What sites, poses and touches are chosen for.
        choice: How many touches at how many table poses, and their shares.
    """

    name: str = "FFS"
    serial: str = ""
    patches: int = 10
    sites: int = 400
    noise: float = 1.0 * UM
    criterion: CriterionOptions = field(default_factory=lambda: CriterionOptions(potential=0.3))
    choice: TouchOptions = field(default_factory=TouchOptions)


@dataclass(frozen=True, eq=False)
class Placement:
    """A standard and the touches it was designed for.

    Attributes:
        standard: Measured against every limit; every patch names the errors it is for.
        requests: The touches.
        criterion: What they were chosen by, on the standard.
        prior_rms: Expected deviation of the tool point before any touch, rms, mm: over the probed
            volume, over the user's workspace.
        rivals: This standard first, then other artefacts at as many touches.
        certificate: How near the touches are to the best choice among all that could be made on the
            standard at its table poses and that keep the same shares of poses, spheres, patches.
        unreachable: Artefacts that are not compared: this machine can make no touch on them.
    """

    standard: Standard
    requests: Requests
    criterion: Criterion
    prior_rms: tuple[float, float]
    rivals: tuple[Rival, ...]
    certificate: Certificate
    unreachable: tuple[str, ...] = ()

    @property
    def own(self) -> Rival:
        """Figures of this standard."""
        return self.rivals[0]


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
        NotBuildable: The blank is larger than the table, or no choice of sites meets every limit;
            the message names what binds.
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
    standard = _standard(criterion.plain, blank, all_poses, options, rng)
    progress("placement", 3, 6)
    plain = criterion.plain.on(standard)
    poses = chosen_poses(plain, standard, all_poses, choice)
    standard = with_optimised_shapes(plain, standard, poses, blank.limits, choice, rng)
    progress("placement", 4, 6)
    here = criterion.on(standard)
    tried = touches_to_choose_from(here, standard, poses, choice)
    chosen, nearness = chosen_touches_on(here, standard, tried, choice)
    requests = tried[chosen]
    standard = _with_shares(criterion, standard, requests)
    progress("placement", 5, 6)
    free = random_touches(
        reach, criterion.volume, criterion.rotary, max(choice.touches, _FREE), rng
    )
    library = visibility(criterion, free)
    lots = random_lots(tried, len(requests), rng)
    own = evaluated(f"standard {options.name}", here, requests, lots, library, len(tried), standard)
    rivals, unreachable = compare(criterion, all_poses, poses, blank, choice, library, rng)
    progress("placement", 6, 6)
    return Placement(
        standard=standard,
        requests=requests,
        criterion=criterion,
        prior_rms=prior_rms(criterion),
        rivals=(own, *rivals),
        certificate=nearness,
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
    blank: Blank,
    poses: Array,
    options: PlacementOptions,
    rng: np.random.Generator,
) -> Standard:
    """Choose sites until the whole body meets every limit."""
    sites = random_sites(blank, options.sites, rng)
    fits = neighbour_gaps(sites, blank) >= blank.limits.gap
    few = spread_poses(poses, 20)
    wanted = joined([_face_touches(f"{i}", site, blank.base, few) for i, site in enumerate(sites)])
    wanted = wanted[criterion.reach.is_reachable(wanted)]
    if not len(wanted):
        raise NotReachable(
            f"no face on any of {len(sites)} sites can be touched at a table pose with every axis "
            "within its travel"
        )
    W, group = criterion.rows(wanted), wanted.feature.astype(np.int64)
    take = max(4, options.choice.touches // options.patches)
    limits = blank.limits
    refused = (
        f"between them the ball of radius {limits.ball_radius:g} mm has to pass with a gap of "
        f"{limits.gap:g} mm"
    )
    binding: list[str] = []
    for _ in range(_REBUILDS):
        chosen = _side_by_side(criterion, W, group, options.patches, take, fits)
        if len(chosen) < options.patches:
            raise NotBuildable(
                f"only {len(chosen)} of {options.patches} patches fit on the blank; {refused}",
                fitting=len(chosen),
            )
        order = sorted(chosen, key=lambda k: (-sites[k].height, sites[k].azimuth))
        try:
            standard = standard_from_sites(
                options.name, [sites[k] for k in order], blank, options.serial
            )
        except NotBuildable as error:
            refused = str(error)
            _forbid(fits, [chosen[-1]])
            continue
        broken = [c for c in constraints(standard, blank.limits) if c.slack < 0.0]
        if not broken:
            return standard
        refused, binding = str(broken[0]), [c.name for c in broken]
        for constraint in broken:
            _blame(fits, constraint.features, order, chosen)
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
) -> list[int]:
    """The sites that are worth most; if their neighbours run out, begun from some that all fit."""
    chosen = best_groups(criterion.objective, W, group, count, take, apart=fits)
    if len(chosen) < count:
        touched = np.isin(np.arange(len(fits)), group)
        begin = most_side_by_side(fits & touched & touched[:, None], count)
        if len(begin) > len(chosen):
            chosen = best_groups(criterion.objective, W, group, count, take, None, fits, begin)
    return chosen


def _face_touches(name: str, site: Site, base: Base, poses: Array) -> Requests:
    """Touches in the corners and the middle of the face of a site, each at every pose."""
    patch = patch_of_site(name, site, base)
    return each_at(patch, face_grid(patch.half_size, 3)[::2], poses)


def _blame(
    fits: NDArray[np.bool_], features: tuple[str, ...], order: list[int], chosen: list[int]
) -> None:
    """Keep the sites that violate a limit from being chosen so again."""
    names = [f"FF{i}" for i in range(1, len(order) + 1)]
    guilty = [order[names.index(name)] for name in features if name in names]
    if len(guilty) == 2 and guilty[0] != guilty[1]:
        fits[guilty[0], guilty[1]] = fits[guilty[1], guilty[0]] = False
    else:
        _forbid(fits, guilty or [chosen[-1]])


def _forbid(fits: NDArray[np.bool_], sites: list[int]) -> None:
    """A site that fits beside nothing, not even as the first."""
    fits[sites, :] = False
    fits[:, sites] = False


def _with_shares(criterion: Criterion, standard: Standard, requests: Requests) -> Standard:
    """The standard with the errors that each patch is for."""
    on_patch = np.isin(requests.feature, [p.name for p in standard.patches])
    touches = criterion.reach.touches(requests[on_patch])
    W = whitened(criterion.model.columns(touches), criterion.model.prior_sd, criterion.noise)
    shares = error_shares(
        W, requests.feature[on_patch].tolist(), parameter_symbols(criterion.model)
    )
    patches = tuple(replace(p, errors=shares.get(p.name, ())) for p in standard.patches)
    return replace(standard, patches=patches)
