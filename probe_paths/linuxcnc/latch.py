"""Error of every touch on a control without a hardware latch.

LinuxCNC samples the probe once in every period of its servo thread and stores the position at that
moment: the axes move on between the contact and the sample.
"""

import numpy as np

SERVO_PERIOD = 1e-3  # period of the servo thread of our machine, s


def latch_error(feed: float, period: float = SERVO_PERIOD, latency: float = 0.0) -> float:
    """Largest distance of a latched position beyond the contact, along the stroke, mm.

    ``feed (period + latency)``: the contact falls anywhere into a period, so that the error is
    uniform between ``feed latency`` and this.

    Args:
        feed: Feed of the touch that measures, mm/s.
        period: Period of the servo thread, s.
        latency: Latency of the probe's signal, s.
    """
    return feed * (period + latency)


def latch_u(feed: float, period: float = SERVO_PERIOD, latency: float = 0.0) -> float:
    """Standard uncertainty of a touch by the latch, mm, about the contact itself.

    The root of the mean square of an error that is uniform between ``a = feed latency`` and
    ``b = feed (period + latency)``: ``sqrt((a^2 + a b + b^2) / 3)``. Nothing is corrected: the
    common part acts as a larger ball, which the calibration of the probe absorbs.

    Args:
        feed: Feed of the touch that measures, mm/s.
        period: Period of the servo thread, s.
        latency: Latency of the probe's signal, s.

    Reference:
        JCGM 100, 4.3.7 (rectangular distribution).
    """
    a, b = feed * latency, latch_error(feed, period, latency)
    return float(np.sqrt((a * a + a * b + b * b) / 3.0))
