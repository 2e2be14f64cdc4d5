"""Chooses patches, table poses and touches by what they tell of the machine.

Candidate sites with random shapes stand all over the blank; every touch that could be made on them
at some table poses is a row ``n^T J`` times the shape functions of the ordinary error model. Sites,
then poses, then single touches are chosen so that the tool point can be predicted best over the
user's poses (`sensitivity.design`), and the finished body is measured against every limit.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from artefact.attribution import error_shares, parameter_symbols
from artefact.candidates import neighbours_fit, random_sites
from artefact.comparison import Rival, before, compare, judged, random_lots
from artefact.constraints import Constraint
from artefact.criterion import Criterion, criterion
from artefact.patch import Surface
from artefact.sites import Frame, Site, patch_of_site, standard_from_sites
from artefact.standard import Standard
from artefact.touchable import Probing, Requests, joined
from sensitivity.blocks import Progress, silent
from sensitivity.design import Quota, Selection, best_groups, exchange, fill
from sensitivity.information import Identifiability, identifiability, whitened
from sensitivity.workspace import Workspace
from twin.errors import NotBuildable, NotReachable
from twin.frames import Array
from twin.ordinary import ordinary_model
from twin.ranges import Ranges
from twin.units import DEG, UM

_REBUILDS = 15
_EDGE = 3.0  # mm a touch stays away from the trimmed edge of a face
_OVERSHOOT = 6.0 * DEG  # left at the ends of a rotary travel, to approach readings from both sides
_SPHERE_LOWEST = -5.0 * DEG  # elevation of the lowest touches on a datum sphere


@dataclass(frozen=True)
class PlacementOptions:
    """How much is tried and how much is measured.

    Attributes:
        name: Type of the standard.
        serial: Of the piece.
        patches: Number of freeform patches.
        touches: Number of touches.
        poses: Number of table poses.
        sites: Number of random sites to choose from.
        noise: Standard deviation of one touch, mm.
        sphere_share: Part of the touches that goes to the datum spheres, at least and at most. They
            would take two thirds if they could, but a standard of spheres is no news, and faces
            are what a freeform standard calibrates.
        least_on_patch: Fewest touches on a patch, as a part of its even share.
    """

    name: str = "FFS"
    serial: str = ""
    patches: int = 10
    touches: int = 480
    poses: int = 18
    sites: int = 400
    noise: float = 1.0 * UM
    sphere_share: tuple[float, float] = (0.15, 0.3)
    least_on_patch: float = 0.4


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
        identifiability: What the touches cannot separate.
    """

    standard: Standard
    requests: Requests
    criterion: Criterion
    before: tuple[float, float]
    rivals: tuple[Rival, ...]
    identifiability: Identifiability

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

    Raises:
        NotBuildable: No choice of sites meets every limit; the message names what binds.
        NotReachable: The machine reaches too few touches on the standard.
    """
    options = options or PlacementOptions()
    model = ordinary_model(probing.chain, ranges)
    aim = criterion(probing, model, frame, workspace, options.noise, rng)
    progress("placement", 1, 6)
    all_poses = table_poses(aim, options.poses)
    standard = _standard(aim, frame, all_poses, options, rng)
    progress("placement", 3, 6)
    poses = _chosen_poses(aim, standard, all_poses, options)
    progress("placement", 4, 6)
    tried = _clear(aim.probing, standard, _touches_at(standard, poses, pitch=5))
    requests = _chosen_touches(aim, standard, tried, options)
    standard = _with_shares(aim, standard, requests)
    progress("placement", 5, 6)
    own = judged(f"standard {options.name}", aim, requests, random_lots(tried, len(requests), rng))
    rivals = compare(aim, poses, len(requests), frame.limits, rng)
    W = aim.whitened(requests)
    progress("placement", 6, 6)
    return Placement(
        standard=standard,
        requests=requests,
        criterion=aim,
        before=before(aim),
        rivals=(own, *rivals),
        identifiability=identifiability(W, aim.prior_sd, model.names),
    )


def table_poses(aim: Criterion, wanted: int) -> Array:
    """Table poses to choose from: a grid of rotary readings in whole degrees, (K, R), rad.

    The values of each later axis are shifted from one value of the earlier ones to the next, so
    that the whole grid holds many different readings of each.
    """
    chain, limits = aim.probing.chain, []
    for name, (low, high) in zip(chain.rotary_axes, aim.rotary, strict=True):
        travel = chain.link(name).range
        limits.append((max(low, travel[0] + _OVERSHOOT), min(high, travel[1] - _OVERSHOOT)))
        if limits[-1][0] > limits[-1][1]:
            raise NotReachable(f"the limits of {name} leave no room to approach a reading")
    if not limits:
        return np.zeros((1, 0))
    total = 6 * wanted
    spans = np.array([high - low for low, high in limits])
    weight = np.sqrt(np.maximum(spans, 1.0 * DEG))
    counts = np.maximum(np.round(weight * (total / weight.prod()) ** (1.0 / len(spans))), 1)
    rows: list[list[float]] = [[]]
    for (low, high), count in zip(limits, counts.astype(int), strict=True):
        step = (high - low) / max(count - 1, 1)
        grown = []
        for i, row in enumerate(rows):
            shift = ((i * 0.618034) % 1.0 - 0.5) * step if row else 0.0
            values = np.clip(np.linspace(low, high, count) + shift, low, high)
            inside = np.clip(np.round(values / DEG), np.ceil(low / DEG), np.floor(high / DEG))
            grown += [[*row, float(v) * DEG] for v in inside]
        rows = grown
    return np.unique(np.array(rows), axis=0)


def _standard(
    aim: Criterion, frame: Frame, poses: Array, options: PlacementOptions, rng: np.random.Generator
) -> Standard:
    """Choose sites until the whole body meets every limit."""
    sites = random_sites(frame, options.sites, rng)
    fits = neighbours_fit(sites, frame.limits)
    few = poses[:: max(1, len(poses) // 20)]
    wanted = joined([_face_touches(f"{i}", site, few) for i, site in enumerate(sites)])
    wanted = wanted[aim.probing.is_reachable(wanted)]
    W, group = aim.rows(wanted), wanted.feature.astype(np.int64)
    take = max(4, options.touches // options.patches)
    refused = ""
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
        broken = [c for c in standard.constraints(frame.limits) if c.slack < 0.0]
        if not broken:
            return standard
        refused = str(broken[0])
        for constraint in broken:
            _blame(fits, constraint, order, chosen)
    raise NotBuildable(f"no choice of {options.patches} patches meets every limit; {refused}")


def _face_touches(name: str, site: Site, poses: Array) -> Requests:
    """Nine touches on the face of a site, each at every pose."""
    patch = patch_of_site(name, site, Frame().base)
    return _each_at(patch, _face_grid(patch.half_size, 3), poses)


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


def _face_grid(half_size: tuple[float, float], count: int) -> Array:
    """Parameters of a regular grid over a face, away from its edges, (count^2, 2)."""
    axes = [np.linspace(-(half - _EDGE), half - _EDGE, count) for half in half_size]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


def _sphere_grid(count: int) -> Array:
    """Azimuth and elevation of directions spread evenly over the upper part of a sphere."""
    i = np.arange(count) + 0.5
    sine = np.sin(_SPHERE_LOWEST) + (1.0 - np.sin(_SPHERE_LOWEST)) * i / count
    return np.stack([(i * np.pi * (3.0 - np.sqrt(5.0))) % (2.0 * np.pi), np.arcsin(sine)], axis=-1)


def _each_at(surface: Surface, uv: Array, poses: Array) -> Requests:
    """Touches at parameters of a surface, each at every pose."""
    n, k = len(uv), len(poses)
    return Requests(
        np.full(n * k, surface.name),
        np.repeat(surface.point(uv), k, axis=0),
        np.repeat(surface.normal(uv), k, axis=0),
        np.tile(poses, (n, 1)),
    )


def _touches_at(standard: Standard, poses: Array, pitch: int) -> Requests:
    """Candidate touches on every face and sphere, `pitch` each way, at every pose."""
    parts = [_each_at(p, _face_grid(p.half_size, pitch), poses) for p in standard.patches]
    parts += [_each_at(s, _sphere_grid(pitch * pitch), poses) for s in standard.spheres]
    return joined(parts)


def _clear(probing: Probing, standard: Standard, wanted: Requests) -> Requests:
    """Those of the touches that machine and probe can make."""
    wanted = wanted[probing.is_reachable(wanted)]
    return wanted[probing.is_clear(standard, wanted)]


def _chosen_poses(
    aim: Criterion, standard: Standard, poses: Array, options: PlacementOptions
) -> Array:
    """Table poses whose touches tell most, (K, R)."""
    tried = _clear(aim.probing, standard, _touches_at(standard, poses, pitch=3))
    if not len(tried):
        raise NotReachable("the machine reaches no touch on the standard at any table pose")
    seen, group = np.unique(np.round(tried.rotary, 9), axis=0, return_inverse=True)
    take = max(4, options.touches // options.poses)
    chosen = best_groups(aim.purpose, aim.rows(tried), group.reshape(-1), options.poses, take)
    picked: Array = seen[sorted(chosen)]
    return picked


def _chosen_touches(
    aim: Criterion, standard: Standard, tried: Requests, options: PlacementOptions
) -> Requests:
    """Single touches: spheres in every pose, every patch, then whatever tells most."""
    n = options.touches
    if len(tried) < n:
        raise NotReachable(f"{len(tried)} touches can be made on the standard, {n} are wanted")
    names = [*(p.name for p in standard.patches), *(s.name for s in standard.spheres)]
    feature = np.array([names.index(f) for f in tried.feature.tolist()])
    pose, poses = tried.pose, int(tried.pose.max()) + 1
    is_sphere = feature >= len(standard.patches)
    aside = np.where(is_sphere, pose * len(names) + feature, poses * len(names))
    per_pose = Quota(pose, np.full(poses, int(np.ceil(1.6 * n / poses))))
    selection = Selection(aim.purpose, aim.rows(tried))
    # one touch on every sphere in every pose that allows it, up to the share of the spheres
    first = Quota(aside, np.append(np.ones(poses * len(names), dtype=np.int64), 0))
    least, most = (round(share * n) for share in options.sphere_share)
    fill(selection, min(least, len(np.unique(aside[is_sphere]))), (first,))
    for patch in range(len(standard.patches)):
        only = Quota((feature != patch).astype(np.int64), np.array([n, 0]))
        enough = round(options.least_on_patch * n / len(names))
        here = int(np.sum(feature == patch))
        fill(selection, int(selection.chosen.sum()) + min(enough, here), (only, per_pose))
    kept = selection.chosen.copy()
    quotas = (per_pose, Quota(is_sphere.astype(np.int64), np.array([n, most])))
    fill(selection, n, quotas)
    exchange(selection, quotas, kept, most=n // 2)
    return tried[selection.chosen]


def _with_shares(aim: Criterion, standard: Standard, requests: Requests) -> Standard:
    """The standard with the errors that each patch is for."""
    on_patch = np.isin(requests.feature, [p.name for p in standard.patches])
    touches = aim.probing.touches(requests[on_patch])
    W = whitened(aim.model.columns(touches), aim.model.prior_sd, aim.noise)
    shares = error_shares(W, requests.feature[on_patch].tolist(), parameter_symbols(aim.model))
    patches = tuple(replace(p, errors=shares.get(p.name, ())) for p in standard.patches)
    return replace(standard, patches=patches)
