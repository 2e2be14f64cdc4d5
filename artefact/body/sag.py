"""Displacements of features where the direction of weight differs from that in calibration.

A standard is calibrated upright. On a tilting table its posts and its plate between the screws bend
under their own weight: ``u = S (g - g0)``, where S is the displacement of a feature per unit
direction of weight, g the direction at a table pose and g0 = -z that in calibration, all in the
artefact frame.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from matstd.twin.frames import Array, inverse, turn
from matstd.twin.machine import Chain, table_to_tool
from matstd.twin.record import Labels

DIRECTIONS = {
    f"{sign}{axis}": (1.0 if sign == "+" else -1.0) * np.eye(3)[i]
    for i, axis in enumerate("XYZ")
    for sign in "+-"
}
"""Possible directions of weight, in machine coordinates."""


@dataclass(frozen=True, eq=False)
class Sag:
    """Displacements of features under the standard's own weight."""

    source: str
    down: str  # direction of weight in machine coordinates, a key of `DIRECTIONS`
    share: float  # standard uncertainty of every displacement, as a share of it
    # by feature, displacement along x, y, z (rows) for weight along x, y, z (columns), (3, 3), mm
    per_weight: Mapping[str, Array]
    # Young's modulus of the computation, N/mm^2; None for a measured sag
    modulus: float | None = None

    def with_modulus(self, modulus: float) -> "Sag":
        """Scaled to another modulus, to which displacements are inversely proportional."""
        assert self.modulus is not None
        ratio = self.modulus / modulus
        scaled = {name: ratio * moved for name, moved in self.per_weight.items()}
        return replace(self, per_weight=scaled, modulus=modulus)

    def moved(self, chain: Chain, q: Array, T_table_artefact: Array, feature: Labels) -> Array:
        """Displacements of features from their calibrated places, artefact frame, (N, 3), mm.

        Args:
            q: Readings, (N, A), mm and rad.
            T_table_artefact: Where the standard stands, (4, 4) or (N, 4, 4).
            feature: Names, (N,); unknown features do not move.
        """
        change = weight_directions(chain, q, T_table_artefact, self.down) - [0.0, 0.0, -1.0]
        out = np.zeros((len(q), 3))
        for name, per_weight in self.per_weight.items():
            rows = feature == name
            out[rows] = change[rows] @ per_weight.T
        return out


def weight_directions(chain: Chain, q: Array, T_table_artefact: Array, down: str) -> Array:
    """Unit vectors along which weight pulls on a standard, artefact frame, (N, 3)."""
    still = q.copy()
    still[:, [chain.axis_index(name) for name in chain.carrying_axes]] = 0.0
    T_machine_table = table_to_tool(chain, still) @ inverse(table_to_tool(chain, q))
    T_machine_artefact = T_machine_table @ T_table_artefact
    return turn(inverse(T_machine_artefact), np.tile(DIRECTIONS[down], (len(q), 1)))
