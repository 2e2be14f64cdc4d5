"""Chooses patches, table poses and touches by what they tell of the machine.

Candidate sites with random shapes stand all over the blank; every touch that could be made on them
at some table poses is a row ``n^T J`` times the shape functions of the expected errors. Sites, then
poses, then single touches are chosen so that the tool point can be predicted best over the
user's poses (`sensitivity.design`), and the finished body is measured against every limit.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from artefact.attribution import error_shares, parameter_symbols
from artefact.candidates import neighbours_fit, random_sites
from artefact.comparison import Rival, before, compare, judged, random_lots
from artefact.constraints import Constraint, constraints
from artefact.criterion import Criterion, criterion, random_touches
from artefact.shaping import shaped
from artefact.sites import Frame, Site, patch_of_site, standard_from_sites
from artefact.standard import Base, Standard
from artefact.touch_choice import (
    PlacementOptions,
    chosen_poses,
    chosen_touches_on,
    each_at,
    face_grid,
    table_poses,
    touches_to_choose_from,
)
from artefact.touchable import Probing, Requests, joined
from artefact.visibility import visibility
from sensitivity.blocks import Progress, silent
from sensitivity.certificate import Certificate
from sensitivity.distributions import Distributions
from sensitivity.groups import best_groups
from sensitivity.information import whitened
from sensitivity.sampling import Population
from sensitivity.workspace import Workspace
from twin.errors import NotBuildable, NotReachable
from twin.frames import Array
from twin.ranges import Ranges

__all__ = ["Placement", "PlacementOptions", "place"]

_FREE = 480  # free touches, at least, by which an effect is judged visible at all
_REBUILDS = 8  # choices of sites tried before giving up


@dataclass(frozen=True, eq=False)
class Placement:
    """A standard and the touches it was designed for.

    Attributes:
        standard: Measured against every limit; every patch names the errors it is for.
        requests: The touches.
        criterion: What they were chosen by.
        before: Expected deviation of the tool point before any touch, rms, mm: over the probed
            volume, over the user's workspace.
        rivals: This standard first, then other artefacts at as many touches.
        certificate: How near the touches are to the best choice among all that could be made on the
            standard at its table poses and that keep the same shares of poses, spheres, patches.
        remarks: What has to be said of the comparison, one line each.
    """

    standard: Standard
    requests: Requests
    criterion: Criterion
    before: tuple[float, float]
    rivals: tuple[Rival, ...]
    certificate: Certificate
    remarks: tuple[str, ...] = ()

    @property
    def own(self) -> Rival:
        """Figures of this standard."""
        return self.rivals[0]


def place(
    probing: Probing,
    frame: Frame,
    workspace: Workspace,
    rng: np.random.Generator,
    ranges: Ranges | None = None,
    options: PlacementOptions | None = None,
    progress: Progress = silent,
    distributions: Distributions | None = None,
    poses_to_try: Array | None = None,
) -> Placement:
    """Design a standard for a machine.

    Args:
        probing: Machine, probe, set-up of the standard.
        frame: Blank, datum features, material, limits.
        workspace: Where the user works: its poses are predicted, its rotary limits are those of the
            table poses.
        rng: Source of the random numbers.
        ranges: Expected amplitudes of the errors; None for the default ones.
        options: How much.
        progress: Told what is being done.
        distributions: Shapes of the errors over the readings; None for the ordinary ones.
        poses_to_try: Table poses to choose from, (K, R), rad; None for a grid over the workspace.

    Raises:
        NotBuildable: The blank is larger than the table, or no choice of sites meets every limit;
            the message names what binds.
        NotReachable: The machine reaches too few touches on the standard.
    """
    options = options or PlacementOptions()
    _check_blank(frame.base, probing)
    population = Population(probing.chain, ranges or Ranges(), distributions or Distributions())
    model = population.expected("w")
    aim = criterion(
        probing,
        model,
        frame,
        workspace,
        options.noise,
        rng,
        options.criterion,
        options.wishes,
        population,
    )
    progress("placement", 1, 6)
    all_poses = table_poses(aim, options.poses) if poses_to_try is None else poses_to_try
    standard = _standard(aim.plain, frame, all_poses, options, rng)
    progress("placement", 3, 6)
    poses = chosen_poses(aim.plain, standard, all_poses, options)
    standard = shaped(aim.plain, standard, poses, frame.limits, options, rng)
    progress("placement", 4, 6)
    tried = touches_to_choose_from(aim, standard, poses, options)
    chosen, nearness = chosen_touches_on(aim, standard, tried, options)
    requests = tried[chosen]
    standard = _with_shares(aim, standard, requests)
    progress("placement", 5, 6)
    free = random_touches(probing, aim.volume, aim.rotary, max(options.touches, _FREE), rng)
    library = visibility(aim, free)
    lots = random_lots(tried, len(requests), rng)
    own = judged(f"standard {options.name}", aim, requests, lots, library, standard)
    remarks: list[str] = []
    rivals = compare(aim, all_poses, poses, frame, options, library, rng, remarks)
    progress("placement", 6, 6)
    return Placement(
        standard=standard,
        requests=requests,
        criterion=aim,
        before=before(aim),
        rivals=(own, *rivals),
        certificate=nearness,
        remarks=tuple(remarks),
    )


def _check_blank(base: Base, probing: Probing) -> None:
    """Refuse a blank whose sides reach beyond the table; its corners may."""
    if max(base.half_size) > probing.table_radius:
        a, b = (2.0 * side for side in base.half_size)
        raise NotBuildable(
            f"a blank of {a:g} x {b:g} mm is larger than the table, diameter "
            f"{2.0 * probing.table_radius:g} mm"
        )


def _standard(
    aim: Criterion, frame: Frame, poses: Array, options: PlacementOptions, rng: np.random.Generator
) -> Standard:
    """Choose sites until the whole body meets every limit."""
    sites = random_sites(frame, options.sites, rng)
    fits = neighbours_fit(sites, frame)
    # spread over the list without the rhythm of its grid
    few = poses[np.unique((np.arange(20) * 0.618034 % 1.0 * len(poses)).astype(np.int64))]
    wanted = joined([_face_touches(f"{i}", site, frame.base, few) for i, site in enumerate(sites)])
    wanted = wanted[aim.probing.is_reachable(wanted)]
    if not len(wanted):
        raise NotReachable(
            f"no face on any of {len(sites)} sites can be touched at a table pose with every axis "
            "within its travel"
        )
    W, group = aim.rows(wanted), wanted.feature.astype(np.int64)
    take = max(4, options.touches // options.patches)
    limits = frame.limits
    refused = (
        f"between them the ball of radius {limits.ball_radius:g} mm has to pass with a gap of "
        f"{limits.gap:g} mm"
    )
    for _ in range(_REBUILDS):
        chosen = best_groups(aim.purpose, W, group, options.patches, take, apart=fits)
        if len(chosen) < options.patches:
            raise NotBuildable(
                f"only {len(chosen)} of {options.patches} patches fit on the blank; {refused}"
            )
        order = sorted(chosen, key=lambda k: (-sites[k].height, sites[k].azimuth))
        try:
            standard = standard_from_sites(
                options.name, [sites[k] for k in order], frame, options.serial
            )
        except NotBuildable as error:
            refused = str(error)
            _forbid(fits, [chosen[-1]])
            continue
        broken = [c for c in constraints(standard, frame.limits) if c.slack < 0.0]
        if not broken:
            return standard
        refused = str(broken[0])
        for constraint in broken:
            _blame(fits, constraint, order, chosen)
    raise NotBuildable(f"no choice of {options.patches} patches meets every limit; {refused}")


def _face_touches(name: str, site: Site, base: Base, poses: Array) -> Requests:
    """Touches in the corners and the middle of the face of a site, each at every pose."""
    patch = patch_of_site(name, site, base)
    return each_at(patch, face_grid(patch.half_size, 3)[::2], poses)


def _blame(
    fits: NDArray[np.bool_], constraint: Constraint, order: list[int], chosen: list[int]
) -> None:
    """Keep the sites that violate a limit from being chosen so again."""
    names = [f"FF{i}" for i in range(1, len(order) + 1)]
    words = [constraint.subject, constraint.name.split()[-1]]
    guilty = [order[names.index(word)] for word in words if word in names]
    if len(guilty) == 2 and guilty[0] != guilty[1]:
        fits[guilty[0], guilty[1]] = fits[guilty[1], guilty[0]] = False
    else:
        _forbid(fits, guilty or [chosen[-1]])


def _forbid(fits: NDArray[np.bool_], sites: list[int]) -> None:
    """A site that fits beside nothing, not even as the first."""
    fits[sites, :] = False
    fits[:, sites] = False


def _with_shares(aim: Criterion, standard: Standard, requests: Requests) -> Standard:
    """The standard with the errors that each patch is for."""
    on_patch = np.isin(requests.feature, [p.name for p in standard.patches])
    touches = aim.probing.touches(requests[on_patch])
    W = whitened(aim.model.columns(touches), aim.model.prior_sd, aim.noise)
    shares = error_shares(W, requests.feature[on_patch].tolist(), parameter_symbols(aim.model))
    patches = tuple(replace(p, errors=shares.get(p.name, ())) for p in standard.patches)
    return replace(standard, patches=patches)
