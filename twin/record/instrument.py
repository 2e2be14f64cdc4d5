"""What measured a run: a touching ball on a standard, or any other instrument along a direction."""

from enum import Enum


class Instrument(Enum):
    """Instruments of a run file; the value stands in its head."""

    TOUCH_PROBE = "touch-probe"
    LASER = "laser"
    TRACKER = "tracker"
    DIAL_GAUGE = "dial-gauge"
    ENCODER = "encoder"
    CMM = "cmm"

    @property
    def is_ball_on_standard(self) -> bool:
        """Whether lobes, radius and bending of a probe, and form and growth of a standard matter.

        A machined part that a CMM measured has no ball of this machine on it.
        """
        return self is Instrument.TOUCH_PROBE
