"""Every feature of a standard as a body that can be pointed at, and what its touches are worth."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import Requests
from matstd.artefact.worth import Criterion
from matstd.information.criteria import Posterior
from matstd.report.machine import standard_bodies
from matstd.twin.frames import Array


class Feature(NamedTuple):
    """A ball or a face, or the rest of the body."""

    name: str  # empty for the rest
    kind: str  # `ball`, `face` or `body`
    colour: str  # as `#rrggbb`
    corners: Array  # artefact frame, (T, 3, 3), mm


def features_of(standard: Standard) -> list[Feature]:
    """All bodies of a standard: the rest first, then balls, then faces."""
    balls = {s.name for s in standard.spheres}
    return [
        Feature(name, "body" if not name else "ball" if name in balls else "face", colour, corners)
        for name, colour, corners in standard_bodies(standard)
    ]


def feature_shares(
    criterion: Criterion, standard: Standard, touches: Requests
) -> Mapping[str, float]:
    """Predicted error of the tool point without the touches on each feature, rms, mm.

    Args:
        criterion: That chose the touches, on no body.
        touches: Those that identify.

    Returns:
        By feature, over the user's workspace; with all touches under the empty name.
    """
    on_body = criterion.on(standard)
    tip = on_body.tip_user
    # the mean over the poses of trace(G Sigma G^T) is that of Sigma times one moment of G
    moment = np.einsum("mip,miq->pq", tip, tip, optimize=True) / len(tip)
    out = {}
    for name in ["", *np.unique(touches.feature).tolist()]:
        left = touches[np.flatnonzero(touches.feature != name)]
        known = Posterior(on_body.known_rows(left), on_body.prior_sd, on_body.model.names)
        out[name] = float(np.sqrt(np.sum(known.covariance * moment)))
    return out
