"""The machine file of a serial arm as a run found it."""

from pathlib import Path

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry import found_arm
from matstd.importers import machine_text
from matstd.report.numbers import microns
from matstd.twin.files import write_whole

FOUND = "machine_found.toml"
"""Machine file of a serial arm with the lines of all joints as found."""


def write_found_arm(folder: Path, fit: Fit, title: str) -> str:
    """Write it, and say what it is good for; nothing, and "", where the machine is no arm."""
    arm = found_arm(fit)
    if arm is None:
        return ""
    write_whole(folder / FOUND, machine_text(arm.chain, title, is_known=True))
    return (
        f"{FOUND} has the lines of all joints as found, to put in the machine file's place: with "
        f"nothing but the set-up {microns(arm.after)} are left then, {microns(arm.before)} now; "
        "take all of them or none, and import again, which finds the reflector anew"
    )
