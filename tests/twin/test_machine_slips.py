"""Slips of units and digits in machine files are refused with what was meant; machines are not."""

from pathlib import Path

import pytest

from matstd.api.machines import machine_file, machine_names
from matstd.twin.errors import BadFile
from matstd.twin.files import read_machine

ROOT = Path(__file__).parents[2]
ALL = [
    *(machine_file(name) for name in machine_names()),
    *(ROOT / "examples").rglob("*machine.toml"),
]
MACHINE = (ROOT / "examples" / "hsm600u-machine.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", ALL, ids=lambda p: f"{p.parent.name}/{p.name}")
def test_machines_have_no_slips(path: Path) -> None:
    read_machine(path)


def changed(tmp_path: Path, *changes: tuple[str, str]) -> Path:
    text = MACHINE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / "machine.toml"
    path.write_text(text, encoding="utf-8")
    return path


B = "[-110.0, 30.0]"
PIVOT = "[0.0, 0.0, -420.0]"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        # -110 and 35 degrees
        (B, "[-1.92, 0.61]", r"axis\.B\.range: .*travel of 2\.53 degrees.*radians, \[-110, 35\]\?"),
        (B, "[-1.5708, 1.5708]", r"is it in radians, \[-90, 90\]\?"),
        (B, "[-6.28, 6.28]", r"is it in radians, \[-360, 360\]\?"),
        ("[-400.0, 400.0]", "[-0.4, 0.4]", r"X\.range: .*0\.8 mm.*metres, \[-400, 400\]\?"),
        (PIVOT, "[0.0, 0.0, -0.42]", r"B\.point: .*is it in metres, \[0, 0, -420\]\?"),
        (PIVOT, "[0.0, 0.0, -42000.0]", r"B\.point: .*mm outside the travels along Z"),
        (PIVOT, "[9500.0, 0.0, -420.0]", r"B\.point: .*mm outside the travels along X"),
        ("[-300.0, 300.0]", "[-300000.0, 300000.0]", r"Y\.range: .*µm, \[-300, 300\]\?"),
        (PIVOT, f"{PIVOT}\ndirection = [0.0, 0.0, 1.0]", r"B\.direction: .*along Y.*is it C\?"),
    ],
)
def test_a_slip_is_refused_with_what_was_meant(tmp_path, old, new, words):
    with pytest.raises(BadFile, match=words):
        read_machine(changed(tmp_path, (old, new)))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (B, "[-5.0, 5.0]"),
        (PIVOT, f"{PIVOT}\ndirection = [0.0, 0.5, 0.866]"),
        (B, "[-3.0, 3.0]"),
        (B, "[-0.5, 0.7]"),
        (PIVOT, "[0.012, 0.0, -419.93]"),
        ("[-400.0, 400.0]", "[-10.0, 10.0]"),
    ],
)
def test_unusual_machines_are_read(tmp_path, old, new):
    read_machine(changed(tmp_path, (old, new)))


def test_a_zero_in_the_centre_of_rotation_is_no_pivot_in_metres(tmp_path):
    """The machine's zero lies near the B line, the table 60 mm below it."""
    origin = ("origin = [0.0, 0.0, -500.0]", "origin = [0.0, 0.0, -60.0]")
    read_machine(changed(tmp_path, (PIVOT, "[0.31, 0.0, -0.42]"), origin))


def test_the_pivot_of_a_head_in_metres(tmp_path):
    text = machine_file("fork").read_text(encoding="utf-8")
    path = tmp_path / "machine.toml"
    path.write_text(text.replace("220.0]", "0.22]"), encoding="utf-8")
    with pytest.raises(BadFile, match=r"axis\.B\.point: .*metres, \[0, 0, 220\]"):
        read_machine(path)
