"""Benefit of a second stylus length or set-up of the standard, at equal numbers of touches.

Half of the touches stay. The other half is chosen greedily from the same points at the same table
poses, once unchanged and once with the other stylus or set-up. Every set-up has six parameters of
its own, every stylus its own offset, length and tilt, so that no knowledge of them is assumed.
Angle and travels are checked, collisions are not.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.reach import ProbeReach, Requests
from matstd.artefact.worth import Criterion, setup_parameters
from matstd.information.criteria import Posterior, mean_prediction, whitened
from matstd.information.identifiability import rank_analysis
from matstd.information.selection import Quota, Selection, fill
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, IntArray, fixed_xyz, pose
from matstd.twin.record import Setup
from matstd.twin.units import DEG

STYLUS_EXTENSION = 60.0  # additional length of a second stylus, mm

SETUPS = {
    "a second set-up, turned by 90° about Z": ((0.0, 0.0, 0.0), (0.0, 0.0, 90.0)),
    "a second set-up, 60 mm aside along X": ((60.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "a second set-up, 60 mm higher": ((0.0, 0.0, 60.0), (0.0, 0.0, 0.0)),
    "a second set-up, tilted by 15° about X": ((0.0, 0.0, 0.0), (15.0, 0.0, 0.0)),
}
"""Displacements (mm) and rotations (degrees) of the standard for a second set-up."""

_POSES_PER_POINT = 6  # table poses tried at every point
_MAX_CANDIDATES = 1500  # candidates for the second half of the touches


@dataclass(frozen=True, eq=False)
class JoinedRows:
    """Rows of touches of which some are made with another stylus or set-up."""

    # whitened rows, (N, P + own): columns of set-up and tool are repeated for a second set-up, a
    # second stylus, so that each has its own
    W: Array
    prior_sd: Array  # shape (P + own,)


@dataclass(frozen=True)
class Alternative:
    """Benefit of another stylus or set-up."""

    name: str
    is_possible: bool
    rank_gained: int  # additional combinations of machine errors that are determined
    # mean predicted variance of the tool point relative to that of as many touches of the design;
    # below one is better
    variance_ratio: float
    refusal: str = ""  # why the machine cannot do it; empty where it can


def other_setups(criterion: Criterion) -> dict[str, ProbeReach]:
    """A second stylus length and further set-ups, by name."""
    reach = criterion.reach
    out = {"a second stylus length": replace(reach, length=reach.length + STYLUS_EXTENSION)}
    for name, (shift, turn) in SETUPS.items():
        T = reach.setup.T_table_artefact @ pose(fixed_xyz(np.array(turn) * DEG), np.array(shift))
        out[name] = replace(reach, setup=Setup("second", T))
    return out


def touches_reached_in(other: ProbeReach, requests: Requests, rng: np.random.Generator) -> Requests:
    """Touches on the same points at the same table poses that another set-up reaches."""
    poses = np.unique(np.round(requests.rotary, 9), axis=0)
    n = len(requests)
    rows = np.tile(np.arange(n), _POSES_PER_POINT)
    tried = replace(requests[rows], rotary=poses[rng.integers(len(poses), size=len(rows))])
    return tried[np.flatnonzero(other.is_reachable(tried))[:_MAX_CANDIDATES]]


def joined_rows(
    criterion: Criterion, first: Requests, second: Requests, other: ProbeReach
) -> JoinedRows:
    """Rows of touches as designed, and of others with another stylus or set-up."""
    model = criterion.model
    W = [
        whitened(model.columns(criterion.reach.touches(first)), criterion.prior_sd, criterion.noise)
    ]
    W.append(whitened(model.columns(other.touches(second)), criterion.prior_sd, criterion.noise))
    own = _own_parameters(criterion, other)
    rows = np.zeros((len(first) + len(second), len(criterion.prior_sd) + len(own)))
    rows[: len(first), : len(criterion.prior_sd)] = W[0]
    rows[len(first) :, : len(criterion.prior_sd)] = W[1]
    rows[len(first) :, own] = 0.0
    rows[len(first) :, len(criterion.prior_sd) :] = W[1][:, own]
    return JoinedRows(rows, np.concatenate([criterion.prior_sd, criterion.prior_sd[own]]))


def _own_parameters(criterion: Criterion, other: ProbeReach) -> IntArray:
    """Parameters that differ with another stylus or set-up: of the tool, or of the set-up."""
    link = "w" if other.length == criterion.reach.length else "t"
    if other is criterion.reach:
        return np.zeros(0, dtype=np.int64)
    return setup_parameters(criterion.model, link)


def machine_rank(criterion: Criterion, W: Array) -> int:
    """Combinations of machine errors that rows determine with unknown set-ups and tools."""
    P = len(criterion.prior_sd)
    nuisance = np.concatenate([setup_parameters(criterion.model), np.arange(P, W.shape[1])])
    return rank_analysis(W).rank - rank_analysis(W[:, nuisance]).rank


def alternatives(
    criterion: Criterion, requests: Requests, rng: np.random.Generator
) -> tuple[Alternative, ...]:
    """Benefit of every other stylus length and set-up."""
    half = requests[::2]
    base = _rank_and_variance(criterion, requests, half, criterion.reach, rng)
    out = []
    for name, other in other_setups(criterion).items():
        try:
            found = _rank_and_variance(criterion, requests, half, other, rng)
        except DesignError as error:
            out.append(
                Alternative(
                    name=name,
                    is_possible=False,
                    rank_gained=0,
                    variance_ratio=1.0,
                    refusal=str(error),
                )
            )
            continue
        gained, ratio = found[0] - base[0], found[1] / base[1]
        out.append(Alternative(name, True, gained, ratio))
    return tuple(out)


def _rank_and_variance(
    criterion: Criterion,
    requests: Requests,
    half: Requests,
    other: ProbeReach,
    rng: np.random.Generator,
) -> tuple[int, float]:
    """Machine rank and mean predicted variance, mm^2, with the other half in another set-up.

    Raises:
        DesignError: The machine reaches too few touches.
    """
    tried = touches_reached_in(other, requests, rng)
    wanted = len(requests) - len(half)
    if len(tried) < wanted:
        raise DesignError(f"the machine reaches {len(tried)} touches, {wanted} are required")
    found = joined_rows(criterion, half, tried, other)
    tips = np.concatenate([criterion.tip_volume, criterion.tip_user])
    extra = found.W.shape[1] - tips.shape[2]
    G = np.concatenate([tips, np.zeros((*tips.shape[:2], extra))], axis=2)
    objective = mean_prediction(G, found.W, found.prior_sd)
    start = np.arange(len(found.W)) < len(half)
    selection = Selection(objective, objective.rows(found.W), start)
    kind = (~start).astype(np.int64)
    fill(selection, len(requests), (Quota(kind, np.array([len(half), wanted])),))
    W = found.W[selection.chosen]
    names = tuple(f"{i}" for i in range(len(found.prior_sd)))
    variance = float(np.mean(Posterior(W, found.prior_sd, names).predicted_sd(G) ** 2))
    return machine_rank(criterion, W), variance
