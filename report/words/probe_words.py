"""Sentences on the pose of a standard, and on changes of the probe that a ball shows."""

from collections.abc import Mapping, Sequence
from datetime import datetime

import numpy as np

from matstd.probe_paths.campaign import BallChange
from matstd.probe_paths.locate import Found
from matstd.twin.frames import fixed_xyz_angles, inverse
from matstd.twin.record import Setup
from matstd.twin.units import DEG, UM


def ball_lines(
    changes: Sequence[BallChange],
    limit: float | None = None,
    heights: Sequence[Mapping[str, float]] = (),
    radii: Sequence[tuple[datetime, float, float]] = (),
    calibrated: Sequence[tuple[float, float]] = (),
) -> list[str]:
    """Changes of ball and probe between measurements of the same ball.

    Args:
        changes: In the order of time.
        limit: Beyond which measurements are rejected, mm; None for no limit.
        heights: Offsets of the ball from commissioning programs, by the meaning of Z, mm.
        radii: From the calibrated ball of the workshop: time, excess of the effective radius of
            the probe over its calibration, and its uncertainty, mm.
        calibrated: Radii of the ball in logs of commissioning programs, which do not test them: as
            calibrated by the control, and as planned, mm.
    """
    lines = []
    for beside in heights:
        best = min(beside, key=lambda meaning: abs(beside[meaning]))
        others = ", ".join(f"{abs(v):.3f} mm as {k}" for k, v in beside.items() if k != best)
        lines.append(
            f"commissioning touch: Z of the control refers to {best} (--z {best}): the ball is "
            f"{abs(beside[best]):.3f} mm off its position, {others}"
        )
    lines += [
        f"commissioning: radius of the ball {known:.4f} mm as calibrated, {planned:.4f} mm as "
        "planned (alarm 101 of the other programs)"
        for known, planned in calibrated
    ]
    lines += [
        f"datum ball at {begin:%H:%M}: effective radius of the probe {excess / UM:+.1f} ± "
        f"{u / UM:.1f} µm beyond its calibration"
        for begin, excess, u in radii
    ]
    within = "" if limit is None else f" (limit {limit / UM:g} µm)"
    for change in changes:
        moved = ", ".join(
            f"{letter} {value / UM:+.1f} ± {u / UM:.1f}"
            for letter, value, u in zip("xyz", change.centre, change.u, strict=False)
        )
        verdict = "" if change.is_seen else ": no significant change"
        lines.append(
            f"ball {change.ball}, {change.before:%H:%M} to {change.after:%H:%M} "
            f"({change.hours:.2f} h, {change.touches} touches): moved by {moved} µm, effective "
            f"radius of the probe {change.radius / UM:+.1f} ± {change.u[3] / UM:.1f} µm"
            f"{within}{verdict}"
        )
        if change.is_odd:
            lines.append(
                f"its touches scatter by {change.scatter / UM:.1f} µm, far more than stated: check "
                "for dirt on the ball or a loose stylus"
            )
    return lines


def located_lines(believed: Setup, stands: Setup, found: Found | None = None) -> list[str]:
    """Offset of a standard from its planned pose, by a search or by the touches of programs."""
    beside = inverse(believed.T_table_artefact) @ stands.T_table_artefact
    shift, angles = beside[:3, 3], fixed_xyz_angles(beside[:3, :3]) / DEG
    u = None if found is None else found.u.reshape(2, 3) / np.array([[1.0], [DEG]])
    lines = ["Offset of the standard from its planned pose:"]
    for i, letter in enumerate("xyz"):
        spread = ["", ""] if u is None else [f" ± {u[0, i]:.3f}", f" ± {u[1, i]:.3f}"]
        lines.append(
            f"- {letter} {shift[i]:+.3f}{spread[0]} mm, about {letter} {angles[i]:+.3f}{spread[1]}°"
        )
    if found is not None:
        other = (
            ""
            if np.isinf(found.next_rms)
            else f", at the second best pose to {found.next_rms:.1f} mm"
        )
        lines.append(f"- the touches fit this pose to {found.rms:.3f} mm rms{other}")
    return lines
