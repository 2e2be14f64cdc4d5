"""What a calibration found, for the console."""

from artefact.certify import Calibrated
from report.numbers import digits
from twin.units import UM, URAD


def calibration_lines(found: Calibrated) -> list[str]:
    """What moved most, every feature with its uncertainty, what was taken for granted."""
    known = found.standard.known
    assert known is not None
    worst = max(found.moved, key=lambda name: found.moved[name])
    lines = [
        f"{len(known.features)} features of '{found.standard.name}' from {known.source}; "
        f"farthest from the design is {worst}, by {_um(found.moved[worst])}"
    ]
    for name, feature in known.features.items():
        text = (
            f"{name}: {feature.points} points, up to {_um(found.moved[name])} off the design, "
            f"{_um(found.left[name])} rms left; u of its place {_um(feature.u)}"
        )
        if feature.u_form:
            tilt = f"{digits(feature.u_tilt / URAD, 2)} µrad"
            text += f", of its tilt {tilt}, of its surface {_um(feature.u_form)}"
        lines.append(text)
    return [*lines, *found.remarks]


def _um(value: float) -> str:
    return f"{digits(value / UM, 2)} µm"
