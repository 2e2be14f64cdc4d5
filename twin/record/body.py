"""What a run states of the size of its standard: its expansion, and how its temperature is known.

Calibrated points hold at 20 degC. A standard at T stands ``alpha (T - 20 degC) p`` beside them, p
from its own origin: where it is really held only displaces it, which the set-up takes up.
"""

from dataclasses import dataclass

BODY = "body"
"""Name of the sensor that sits on the standard: column `T_body_degC`."""


@dataclass(frozen=True, slots=True)
class Body:
    """The standard as a body that expands.

    Attributes:
        alpha: Coefficient of linear expansion, 1/K.
        u_alpha: Its standard uncertainty, 1/K.
        u_temperature: That of its temperature, K, the same error at all touches of a run.
        is_known: Whether its temperature was stated; else points stay those of 20 degC.
    """

    alpha: float
    u_alpha: float
    u_temperature: float
    is_known: bool
