"""What a standard buys over the artefacts that people have, at equal touches and table poses."""

from dataclasses import dataclass

import numpy as np

from artefact.candidates import smooth_heights
from artefact.constraints import Limits
from artefact.criterion import Criterion, random_touches
from artefact.freeform import graph_patch
from artefact.touchable import Requests, joined
from sensitivity.design import Selection, exchange, fill
from sensitivity.information import Posterior, prior_sd_of_tip
from twin.frames import Array, pose

_TRIED = 3000  # touches that each artefact may choose from
_DRAWS = 5  # of random touches, averaged


@dataclass(frozen=True)
class Rival:
    """One artefact at the same number of touches and the same table poses.

    Attributes:
        name: What it is.
        rms: Predicted root mean square of the unknown tool point deviation over the probed volume
            after chosen touches, mm.
        p95: 95 % of the poses stay below this, mm.
        rms_user: The same as `rms` over the user's workspace, mm.
        rms_random: As `rms`, after touches taken at random on the same artefact, mm.
        estimable: Combinations of parameters that are determined (effective degrees of freedom).
    """

    name: str
    rms: float
    p95: float
    rms_user: float
    rms_random: float
    estimable: float


def judged(name: str, aim: Criterion, chosen: Requests, random: list[Requests]) -> Rival:
    """Figures of one artefact after its touches.

    Args:
        name: What it is.
        aim: Criterion.
        chosen: Its touches.
        random: Lots of touches taken at random on it, as many in each.
    """
    after = _posterior(aim, chosen)
    over = after.predicted_sd(aim.tip_volume)
    by_chance = [_rms(_posterior(aim, lot).predicted_sd(aim.tip_volume)) for lot in random]
    return Rival(
        name=name,
        rms=_rms(over),
        p95=float(np.quantile(over, 0.95)),
        rms_user=_rms(after.predicted_sd(aim.tip_user)),
        rms_random=float(np.sqrt(np.mean(np.square(by_chance)))),
        estimable=after.degrees_of_freedom,
    )


def _posterior(aim: Criterion, touches: Requests) -> Posterior:
    return Posterior(aim.whitened(touches), aim.prior_sd, aim.model.names)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def before(aim: Criterion) -> tuple[float, float]:
    """Root mean square of the expected deviation before any touch, mm: probed volume, user's.

    The set-up counts with what the machine's error ranges say of it, not as unknown.
    """
    return (
        _rms(prior_sd_of_tip(aim.tip_volume, aim.model.prior_sd)),
        _rms(prior_sd_of_tip(aim.tip_user, aim.model.prior_sd)),
    )


def compare(
    aim: Criterion, poses: Array, count: int, limits: Limits, rng: np.random.Generator
) -> tuple[Rival, ...]:
    """Four spheres, one freeform face and a random scatter of points and normals.

    Each may choose its touches from 3000 reachable ones by the same greedy choice and exchange, at
    the same table poses. Room for the probe is not asked of them, which favours them.

    Args:
        aim: Criterion.
        poses: Table poses, (K, R), rad.
        count: Number of touches.
        limits: Of the freeform face.
        rng: Source of the random numbers.
    """
    artefacts = {
        "four calibrated spheres": _four_spheres(aim, poses, rng),
        "one freeform face": _one_face(aim, poses, limits, rng),
        "random points and normals": _scatter(aim, poses, rng),
    }
    return tuple(
        judged(name, aim, chosen_touches(aim, tried, count), random_lots(tried, count, rng))
        for name, tried in artefacts.items()
    )


def random_lots(tried: Requests, count: int, rng: np.random.Generator) -> list[Requests]:
    """A few lots of touches taken at random from those that could be made."""
    size = min(count, len(tried))
    return [tried[rng.choice(len(tried), size, replace=False)] for _ in range(_DRAWS)]


def chosen_touches(aim: Criterion, tried: Requests, count: int) -> Requests:
    """Touches chosen greedily and mended by exchange, without any quota."""
    selection = Selection(aim.purpose, aim.rows(tried))
    fill(selection, min(count, len(tried)))
    exchange(selection, most=count // 4)
    return tried[selection.chosen]


def _at_poses(
    aim: Criterion, point: Array, normal: Array, poses: Array, rng: np.random.Generator
) -> Requests:
    """Reachable touches at points, each at every pose, thinned to the number that may be tried."""
    n, k = len(point), len(poses)
    wanted = Requests(
        np.full(n * k, "artefact"),
        np.repeat(point, k, axis=0),
        np.repeat(normal, k, axis=0),
        np.tile(poses, (n, 1)),
    )
    good = np.flatnonzero(aim.probing.is_reachable(wanted))
    return wanted[rng.permutation(good)[:_TRIED]]


def _four_spheres(aim: Criterion, poses: Array, rng: np.random.Generator) -> Requests:
    """Spheres of 25 mm at the corners of the volume, at different heights."""
    (x0, y0, z0), (x1, y1, z1) = aim.volume
    heights = np.linspace(z0 + 25.0, z1, 4)
    centres = np.array([[x0, y0, 0.0], [x1, y0, 0.0], [x1, y1, 0.0], [x0, y1, 0.0]])
    centres[:, 2] = heights[[0, 2, 1, 3]]
    normal = rng.normal(size=(120, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    point = (centres[:, None] + 12.5 * normal).reshape(-1, 3)
    return _at_poses(aim, point, np.tile(normal, (4, 1)), poses, rng)


def _one_face(aim: Criterion, poses: Array, limits: Limits, rng: np.random.Generator) -> Requests:
    """One smooth face over the whole volume, as steep as the limits allow, in mid-height."""
    (x0, y0, z0), (x1, y1, z1) = aim.volume
    half = (0.5 * (x1 - x0), 0.5 * (y1 - y0))
    place = pose(t=np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (z0 + z1)]))
    face = graph_patch("face", place, half, smooth_heights(half, limits, rng, tallest=40.0))
    uv = rng.uniform(-1.0, 1.0, (300, 2)) * np.array(half)
    return _at_poses(aim, face.point(uv), face.normal(uv), poses, rng)


def _scatter(aim: Criterion, poses: Array, rng: np.random.Generator) -> Requests:
    """Points anywhere in the volume with any normal: no artefact, but what one could hope for."""
    parts = [
        random_touches(
            aim.probing, aim.volume, np.stack([p, p], axis=-1), _TRIED // len(poses), rng
        )
        for p in poses
    ]
    return joined(parts)
