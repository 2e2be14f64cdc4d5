"""What a law looks like to a metrologist: a cause to look for."""

from matstd.twin.laws import ON_BALL, Law

_LOOKS = {
    ("bump", "linear"): "It looks like a hose or a cable chain, or a worn place of a guide.",
    ("plateau", "linear"): "It looks like a worn zone of a scale or of a guide.",
    ("window", "linear"): "It looks like a hose, a stop or a damaged stretch of a scale.",
    ("step", "time"): "It looks like something that was changed: a stylus, a clamp, a part.",
    ("square", "time"): "It looks like something that switches: coolant, a pump, a chiller.",
    ("saw", "time"): "It looks like a controller with two limits: a cooler, a level.",
    ("sine", "time"): "It looks like a cycle of a cooler or of the room.",
    ("sine", "linear"): "It looks like a screw, a rack or the interpolation of an encoder; across "
    "the axis, like the bolts or the rolling elements of a guide.",
    ("exp", "time"): "It looks like something that relaxes or warms: a clamping, a drive.",
    ("settling", "time"): "It looks like something that relaxes or warms: a clamping, a drive.",
    ("log", "time"): "It looks like creep.",
    ("kink", "linear"): "It looks like a counterweight, a bearing or a stop that begins to carry.",
    ("kink-before", "linear"): "It looks like a counterweight, a bearing or a stop.",
    ("kink", "level"): "It looks like a threshold: a thermostat, a gap that closes.",
    ("play", "level"): "It looks like friction between bodies that expand differently.",
    ("hysteresis", "level"): "It looks like friction between bodies that expand differently.",
    ("harmonic", "rotary"): "It looks like cogging, a bearing or the disc of an encoder.",
}

_FORM = (
    "It looks like the form of the standard: it depends on the contact, and turns with a rotary "
    "axis. Calibrate the form, or probe again with the standard turned in its clamping."
)


def looks_like(law: Law) -> str:
    """What to look for; empty where nothing is known.

    Lobes of a ball, which turn with the table, were learnt as a harmonic of C times a sine over the
    azimuth of the contact, and a second run was predicted with 1.30 µm instead of 1.05.
    """
    turning = [driver.name for driver in law.drivers if driver.nature == "rotary"]
    if len({name in ON_BALL for name in turning}) == 2:
        return _FORM
    factors = [(f.shape.word, f.driver.nature) for f in law.factors]
    return next((_LOOKS[f] for f in factors if f in _LOOKS), "")
