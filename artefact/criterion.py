"""What touches on a standard are worth: how well the tool point can be predicted after them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from artefact.sites import Frame
from artefact.touchable import Probing, Requests
from sensitivity.blocks import blocks
from sensitivity.design import Purpose, purpose
from sensitivity.information import whitened
from sensitivity.workspace import Box, Workspace, latin_hypercube
from twin.errors import DesignError
from twin.frames import Array
from twin.model import Model
from twin.symbols import Family
from twin.touches import at_poses

SETUP_SD = (1.0, 5e-3)
"""How far the standard may stand from where it is believed to stand, mm and rad. It is never known,
so the set-up of the workpiece is free and the tool point is predicted relative to the standard."""

CRITERIA = {
    "I": "mean variance of the predicted tool point over probed volume and workspace",
    "D": "volume of what stays unknown of the parameters, in units of what is expected",
    "A": "mean variance of the parameters, in units of what is expected",
}
"""What touches can be chosen for."""

_POSES = 400  # over which predictions are judged, in the probed volume and as many of the user's
_SCATTER = 3000  # random touches that span all that touches can show
_ROWS_A_BLOCK = 4000


@dataclass(frozen=True, eq=False)
class Criterion:
    """Worth of touches on a machine.

    Attributes:
        probing: Machine, probe, set-up.
        model: Errors that are expected.
        prior_sd: Their standard deviations with the set-up free, (P,).
        noise: Standard deviation of one touch, mm.
        rotary: Smallest and largest reading of every rotary axis, (R, 2), rad.
        volume: Box that the standard fills, artefact frame, mm.
        tip_volume: Deviation of the tip per unit of every parameter at poses over the probed
            volume, (M, 3, P).
        tip_user: The same at poses over the user's workspace, (M, 3, P).
        purposes: What touches can be chosen for, by the names in `CRITERIA`.
        name: The one that they are chosen for.
    """

    probing: Probing
    model: Model
    prior_sd: Array
    noise: float
    rotary: Array
    volume: Box
    tip_volume: Array
    tip_user: Array
    purposes: Mapping[str, Purpose]
    name: str = "I"

    @property
    def purpose(self) -> Purpose:
        """What touches are chosen for."""
        return self.purposes[self.name]

    def whitened(self, wanted: Requests) -> Array:
        """Rows of touches in units of noise and prior, (N, P)."""
        out = np.empty((len(wanted), len(self.prior_sd)))
        for rows in blocks(len(wanted), _ROWS_A_BLOCK):
            columns = self.model.columns(self.probing.touches(wanted[rows]))
            out[rows] = whitened(columns, self.prior_sd, self.noise)
        return out

    def rows(self, wanted: Requests) -> Array:
        """Rows of touches in the directions that matter, (N, R)."""
        return self.purpose.rows(self.whitened(wanted))


def criterion(
    probing: Probing,
    model: Model,
    frame: Frame,
    workspace: Workspace,
    noise: float,
    rng: np.random.Generator,
    name: str = "I",
) -> Criterion:
    """Criterion of a machine, a blank and a user's workspace.

    Args:
        probing: Machine, probe, set-up.
        model: Errors that are expected, with their prior standard deviations.
        frame: Blank of the standard: it bounds the probed volume.
        workspace: Where the user works; the limits of its rotary axes are those of table poses.
        noise: Standard deviation of one touch, mm.
        rng: Draws the poses.
        name: One of `CRITERIA`.

    Raises:
        DesignError: Another name.
    """
    if name not in CRITERIA:
        raise DesignError(f"criterion '{name}', expected one of {', '.join(CRITERIA)}")
    chain = probing.chain
    half, top = frame.base.half_size, frame.blank_height
    volume: Box = (
        (-0.8 * half[0], -0.8 * half[1], frame.base.thickness),
        (0.8 * half[0], 0.8 * half[1], 0.7 * top),
    )
    rotary = np.array([workspace.limit(name) for name in chain.rotary_axes]).reshape(-1, 2)
    limits = {name: workspace.limit(name) for name in chain.rotary_axes}
    origin = probing.setup.T_table_artefact[:3, 3]
    corners = np.array(volume) + origin
    box: Box = (tuple(corners[0]), tuple(corners[1]))
    probed = Workspace(chain, limits, probing.length, box)
    tips = []
    for area, length in ((probed, probing.length), (workspace, workspace.length)):
        q = latin_hypercube(area, _POSES, rng)
        tips.append(model.tip_columns(at_poses(chain, q, length)))
    prior_sd = _with_free_setup(model)
    scatter = random_touches(probing, volume, rotary, _SCATTER, rng)
    W = whitened(model.columns(probing.touches(scatter)), prior_sd, noise)
    to_predict = purpose(np.concatenate(tips), W, prior_sd)
    return Criterion(
        probing=probing,
        model=model,
        prior_sd=prior_sd,
        noise=noise,
        rotary=rotary,
        volume=volume,
        tip_volume=tips[0],
        tip_user=tips[1],
        purposes={
            "I": to_predict,
            "D": replace(to_predict, is_determinant=True),
            "A": replace(to_predict, K=np.eye(len(to_predict.K))),
        },
        name=name,
    )


def _with_free_setup(model: Model) -> Array:
    """Prior standard deviations with the set-up of the workpiece as good as unknown."""
    prior_sd = model.prior_sd.copy()
    for i, (effect, _) in enumerate(model.parameters):
        symbol = getattr(effect, "symbol", None)
        if symbol is not None and symbol.family is Family.SETUP and symbol.link == "w":
            prior_sd[i] = SETUP_SD[int(symbol.is_angular)]
    return prior_sd


def random_touches(
    probing: Probing, volume: Box, rotary: Array, count: int, rng: np.random.Generator
) -> Requests:
    """Touches with random points in a box and random normals, at random poses, all reachable.

    Args:
        probing: Machine, probe, set-up.
        volume: Box in the artefact frame, mm.
        rotary: Limits of every rotary axis (R, 2), from which readings are drawn evenly, rad.
        count: Number of touches; fewer where the machine reaches fewer.
        rng: Source of the random numbers.
    """
    low, high = np.array(volume)
    tries = 6 * count
    normal = rng.normal(size=(tries, 3))
    wanted = Requests(
        feature=np.full(tries, "scatter"),
        point=rng.uniform(low, high, (tries, 3)),
        normal=normal / np.linalg.norm(normal, axis=1, keepdims=True),
        rotary=rng.uniform(rotary[:, 0], rotary[:, 1], (tries, len(rotary))),
    )
    return wanted[np.flatnonzero(probing.is_reachable(wanted))[:count]]
