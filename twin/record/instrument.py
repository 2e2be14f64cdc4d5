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
    BALL_BAR = "ball-bar"
    AUTOCOLLIMATOR = "autocollimator"

    @property
    def is_ball_on_standard(self) -> bool:
        """Whether lobes, radius and bending of a probe, and form and growth of a standard matter.

        A machined part that a CMM measured has no ball of this machine on it.
        """
        return self is Instrument.TOUCH_PROBE

    @property
    def reads_by_the_axes(self) -> bool:
        """Whether the axes move until it responds, so that their readings hold what it measured."""
        return self in (Instrument.TOUCH_PROBE, Instrument.DIAL_GAUGE)

    @property
    def reads_angle(self) -> bool:
        """Whether it feels how the tool turns relative to the table, and no displacement.

        A row then is that angle times the arm p, along n: a point seen together with the one
        opposite, behind the origin of its set-up.
        """
        return self is Instrument.AUTOCOLLIMATOR

    @property
    def has_standard(self) -> bool:
        """Whether something stands on the table that may slip."""
        return self not in (Instrument.ENCODER, Instrument.AUTOCOLLIMATOR)
