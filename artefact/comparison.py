"""What a standard buys over the artefacts that people have, at equal touches and table poses."""

from dataclasses import dataclass

import numpy as np

from artefact.criterion import Criterion, random_touches
from artefact.rivals import rivals
from artefact.sites import Frame
from artefact.standard import Standard
from artefact.touch_choice import (
    PlacementOptions,
    chosen_poses,
    pose_quota,
    some_touches,
)
from artefact.touchable import Requests, joined
from artefact.visibility import Visibility
from sensitivity.design import Purpose, Selection, exchange, fill
from sensitivity.information import Posterior, prior_sd_of_tip
from twin.errors import NotReachable
from twin.frames import Array

_TRIED = 3000  # touches that the ideal scatter may choose from
_DRAWS = 5  # of random touches, averaged


@dataclass(frozen=True)
class Rival:
    """One artefact at the same number of touches and of table poses, under the same rules.

    Attributes:
        name: What it is.
        rms: Predicted root mean square of the unknown tool point deviation over the probed volume
            after chosen touches, mm.
        p95: 95 % of the poses stay below this, mm.
        rms_user: The same as `rms` over the user's workspace, mm.
        p95_user: The same as `p95` over the user's workspace, mm.
        rms_random: As `rms`, after touches taken at random on the same artefact, mm.
        estimable: Combinations of parameters that are determined (effective degrees of freedom).
        visible: Effects of the library, of those that any touches could show, that these show.
        could_be_visible: Number of effects that any touches could show.
        touches: What it is judged by.
        body: What is touched; None for scatter that no body has.
    """

    name: str
    rms: float
    p95: float
    rms_user: float
    p95_user: float
    rms_random: float
    estimable: float
    visible: int
    could_be_visible: int
    touches: Requests
    body: Standard | None = None


def judged(
    name: str,
    aim: Criterion,
    chosen: Requests,
    random: list[Requests],
    library: Visibility,
    body: Standard | None = None,
) -> Rival:
    """Figures of one artefact after its touches.

    Args:
        name: What it is.
        aim: Criterion.
        chosen: Its touches.
        random: Lots of touches taken at random on it, as many in each.
        library: Effects of the library that touches could show.
        body: What is touched; None for scatter that no body has.
    """
    after = _posterior(aim, chosen)
    over = after.predicted_sd(aim.tip_volume)
    of_user = after.predicted_sd(aim.tip_user)
    by_chance = [_rms(_posterior(aim, lot).predicted_sd(aim.tip_volume)) for lot in random]
    return Rival(
        name=name,
        rms=_rms(over),
        p95=float(np.quantile(over, 0.95)),
        rms_user=_rms(of_user),
        p95_user=float(np.quantile(of_user, 0.95)),
        rms_random=float(np.sqrt(np.mean(np.square(by_chance)))),
        estimable=after.degrees_of_freedom,
        visible=library.shown(aim, chosen),
        could_be_visible=len(library.effects),
        touches=chosen,
        body=body,
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
    aim: Criterion,
    all_poses: Array,
    poses: Array,
    frame: Frame,
    options: PlacementOptions,
    library: Visibility,
    rng: np.random.Generator,
    remarks: list[str] | None = None,
) -> tuple[Rival, ...]:
    """Other artefacts at as many touches: bodies that people have, and scatter that nobody has.

    Bodies choose their own table poses and touches as the standard does, and the probe needs the
    same angle, travel, room and free way on them; only the share of the spheres is not limited.
    The ideal scatter has points anywhere in the volume and any normal, and nothing is in its way.

    Args:
        aim: Criterion.
        all_poses: Table poses that bodies choose from, (K, R), rad.
        poses: Table poses of the scatter.
        frame: Base, blank and limits of the standard.
        options: Numbers of touches and poses.
        library: Effects of the library that touches could show.
        rng: Source of the random numbers.
        remarks: Takes a line for every body that cannot be touched at all, or not often enough.
    """
    out, said = [], [] if remarks is None else remarks
    for name, body in rivals(aim.volume, frame, rng).items():
        try:
            own = chosen_poses(aim.plain, body, all_poses, options)
            tried = some_touches(aim, body, own, options, rng)
        except NotReachable:
            said.append(f"Not compared with: {name}; this machine can make no touch on it.")
            continue
        points = len(np.unique(np.column_stack([tried.point, tried.rotary]), axis=0))
        if points < options.touches:
            said.append(
                f"{name}: {points} touches can be made on it, {options.touches} are compared; "
                "some are made more than once."
            )
        lots = random_lots(tried, options.touches, rng)
        chosen = chosen_touches(aim, aim.purpose, tried, options)
        out.append(judged(name, aim, chosen, lots, library, body))
    tried = _scatter(aim, poses, rng)
    lots = random_lots(tried, options.touches, rng)
    for name, what_for in (("I", aim.purposes["I"]), ("D", aim.purposes["D"])):
        chosen = chosen_touches(aim, what_for, tried, options)
        out.append(judged(f"ideal scatter, chosen by {name}", aim, chosen, lots, library))
    out.append(judged("ideal scatter, at random", aim, lots[0], lots, library))
    return tuple(out)


def random_lots(tried: Requests, count: int, rng: np.random.Generator) -> list[Requests]:
    """A few lots of touches taken at random from those that could be made."""
    size = min(count, len(tried))
    return [tried[rng.choice(len(tried), size, replace=False)] for _ in range(_DRAWS)]


def chosen_touches(
    aim: Criterion, what_for: Purpose, tried: Requests, options: PlacementOptions
) -> Requests:
    """Touches chosen greedily and mended by exchange, with no quota but that of the poses."""
    count = min(options.touches, len(tried))
    quotas = (pose_quota(tried, options.touches),)
    selection = Selection(what_for, aim.rows(tried))
    fill(selection, count, quotas)
    exchange(selection, quotas, most=count // 4)
    return tried[selection.chosen]


def _scatter(aim: Criterion, poses: Array, rng: np.random.Generator) -> Requests:
    """Points anywhere in the volume with any normal: no artefact, but what one could hope for."""
    parts = [
        random_touches(
            aim.probing, aim.volume, np.stack([p, p], axis=-1), _TRIED // len(poses), rng
        )
        for p in poses
    ]
    return joined(parts)
