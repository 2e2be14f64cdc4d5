"""Slips of units and digits in machine files are refused with what was meant; machines are not."""

import math
import re
from ast import literal_eval
from pathlib import Path

import pytest

from matstd.api.machines import machine_file, machine_names
from matstd.commands.machine.new import template
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
ORIGIN = "origin = [0.0, 0.0, -500.0]"
PIVOT = "[0.0, 0.0, -420.0]"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        # -110 and 35 degrees
        (B, "[-1.92, 0.61]", r"axis\.B\.range: .*travel of 2\.53 degrees.*radians, \[-110, 35\]\?"),
        (B, "[-1.5708, 1.5708]", r"is it in radians, \[-90, 90\]\?"),
        (B, "[-1.658, 0.26]", r"is it in radians, \[-95, 15\]\?"),  # two decimals beside three
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
        ("[-400.0, 400.0]", "[-60.0, 60.0]"),
        (ORIGIN, "origin = [3.0, -3.9, -500.0]"),
        (ORIGIN, "origin = [0.0, 0.0, -890.0]"),
    ],
)
def test_unusual_machines_are_read(tmp_path, old, new):
    read_machine(changed(tmp_path, (old, new)))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[-400.0, 400.0]", "[-40.0, 40.0]", "80 mm beside 500 mm of the next axis"),
        ("[-300.0, 300.0]", "[-30.0, 30.0]", "60 mm beside 500 mm of the next axis"),
        ("[-500.0, 0.0]", "[-50.0, 0.0]", "50 mm beside 600 mm of the next axis"),
    ],
)
def test_a_travel_in_centimetres_is_asked_about_at_its_axis(tmp_path, old, new, words):
    """What is proposed is the machine as it was; a machine that is so may confirm it."""
    asked = changed(tmp_path, (old, new))
    with pytest.raises(BadFile, match=words) as refusal:
        read_machine(asked)
    said = str(refusal.value)
    (key,) = re.findall(r"axis\.([XYZ])\.range: found", said)
    proposed = literal_eval(re.findall(r"in cm, (\[.*?\])\?", said)[0])
    assert proposed == literal_eval(old)
    inches = literal_eval(re.findall(r"in inches, (\[.*?\])", said)[0])
    assert inches == pytest.approx([2.54 * end for end in proposed])
    confirmed = changed(tmp_path, (old, new), ("[axis.X]", f"{stated(said)}\n\n[axis.X]"))
    assert read_machine(confirmed).link(key).range == tuple(literal_eval(new))


def stated(refusal: str) -> str:
    """The line with which a refusal says that a value may be confirmed."""
    return re.findall(r"confirmed = \[.*?\]", refusal)[0]


def test_all_travels_in_centimetres_are_asked_about_at_once(tmp_path):
    """The table then lies 450 mm below the end of Z, nine of its travels."""
    changes = [(f"[-{v}.0, {w}.0]", f"[-{v / 10}, {w / 10}]") for v, w in TRAVELS]
    with pytest.raises(BadFile, match="3 faults") as refusal:
        read_machine(changed(tmp_path, *changes))
    assert re.findall(r"axis\.(.)\.range: found", str(refusal.value)) == ["X", "Y", "Z"]
    assert "a table 450 mm beyond" in str(refusal.value)


TRAVELS = ((400, 400), (300, 300), (500, 0))


@pytest.mark.parametrize(
    ("origin", "words"),
    [
        ([36.0, -48.0, -500.0], "60 mm off the line of C"),  # 36² + 48² = 60²
        ([0.0, 0.0, -1500.0], "1000 mm beyond the travel along Z"),
        ([0.0, 0.0, 500.0], "500 mm beyond the travel along Z"),
        ([0.0, 0.0, -30.0], "with Z up to 0"),
        ([-900.0, 0.0, -500.0], "500 mm beyond the travel along X"),
    ],
)
def test_a_table_beside_its_line_or_out_of_reach_is_asked_about(tmp_path, origin, words):
    asked = (ORIGIN, f"origin = {origin}")
    with pytest.raises(BadFile, match=rf"workpiece\.origin: found .*{words}") as refusal:
        read_machine(changed(tmp_path, asked))
    line = stated(str(refusal.value))
    assert line == 'confirmed = ["workpiece.origin"]'
    chain = read_machine(changed(tmp_path, asked, ("[axis.X]", f"{line}\n\n[axis.X]")))
    assert chain.table_origin.tolist() == origin


@pytest.mark.parametrize(
    ("point", "away"),
    [
        ("[-620.0, 0.0, -420.0]", "220 mm outside the travels along X"),
        ("[501.0, 0.0, -420.0]", "101 mm outside the travels along X"),
        ("[499.0, 0.0, -420.0]", ""),
        ("[0.0, 450.0, -420.0]", ""),  # along its own line
    ],
)
def test_a_line_of_a_table_beside_the_travels_is_asked_about(tmp_path, point, away):
    """X travels from -400 to 400 mm; B turns about a line along Y."""
    path = changed(tmp_path, (PIVOT, point))
    if away:
        with pytest.raises(BadFile, match=rf"axis\.B\.point: .*{away}") as refusal:
            read_machine(path)
        line = stated(str(refusal.value))
        assert line == 'confirmed = ["axis.B.point"]'
        path = changed(tmp_path, (PIVOT, point), ("[axis.X]", f"{line}\n\n[axis.X]"))
    assert read_machine(path).link("B").point.tolist() == literal_eval(point)


def test_an_inclined_line_of_a_table_beside_the_travels_is_asked_about(tmp_path):
    text = template("machine", "swivel-45")
    (point,) = re.findall(r"\[axis\.B\]\n(?:.+\n)*?point = (\[.*?\])", text)
    path = tmp_path / "machine.toml"
    x, y, z = literal_eval(point)
    path.write_text(text.replace(point, f"[{x - 520.0}, {y}, {z}]", 1), encoding="utf-8")
    with pytest.raises(BadFile, match=r"axis\.B\.point: .*220 mm outside the travels along X"):
        read_machine(path)


def test_a_cradle_may_carry_its_table_at_any_height(tmp_path):
    """A line of X below a plate: seen along the tool they cross. Beside it, they do not."""
    text = (ROOT / "examples/machines/four-axis-machine.toml").read_text(encoding="utf-8")
    path = tmp_path / "machine.toml"
    for place, off in (("[0.0, 0.0, -330.0]", None), ("[0.0, 25.0, -330.0]", "25 mm off")):
        path.write_text(re.sub(r"origin = \[.*\]", f"origin = {place}", text), encoding="utf-8")
        if off is None:
            read_machine(path)
            continue
        with pytest.raises(BadFile, match=f"{off} the line of A"):
            read_machine(path)


def test_what_is_confirmed_must_be_asked_about(tmp_path):
    for line in ('confirmed = ["axis.X.range"]', 'confirmed = ["axis.X.rnage"]'):
        with pytest.raises(BadFile, match=r"confirmed: found .*expected keys that are asked about"):
            read_machine(changed(tmp_path, ("[axis.X]", f"{line}\n\n[axis.X]")))


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


@pytest.mark.parametrize(
    ("name", "point"),
    [
        ("trunnion", "[0.0, 0.0, -450.0]"),
        ("four-axis", "[0.0, 0.0, -450.0]"),
        ("horizontal", "[0.0, 0.0, -650.0]"),
        ("gantry", "[0.0, 0.0, 200.0]"),
        ("head-table", "[0.0, 0.0, 200.0]"),
    ],
)
def test_a_pivot_of_the_other_sign_is_asked_about(tmp_path, name, point):
    """By more than any travel of the tool the line is then elsewhere; the file may confirm it."""
    text = (ROOT / f"examples/machines/{name}-machine.toml").read_text(encoding="utf-8")
    x, y, z = literal_eval(point)
    path = tmp_path / "machine.toml"
    path.write_text(text.replace(point, f"[{x}, {y}, {-z}]"), encoding="utf-8")
    with pytest.raises(BadFile, match=r"\.point: .*is it \[0, 0, (-?\d+)\]\?") as refusal:
        read_machine(path)
    assert f"is it [0, 0, {z:g}]?" in str(refusal.value)
    # a line below the gauge point may be that of a table, and lack its prime
    assert ("turn the table" in str(refusal.value)) is (z > 0)
    line = stated(str(refusal.value))
    path.write_text(f"{line}\n" + path.read_text(encoding="utf-8"), encoding="utf-8")
    read_machine(path)


@pytest.mark.parametrize(("angle", "spans"), [(0.0134, False), (0.0149, True)])
def test_linear_axes_within_a_degree_of_one_another_span_nothing(tmp_path, angle, spans):
    """Of two unit vectors the smallest singular value is sqrt(1 - cos a): 0.0095, and 0.0105.

    With three axes that span, the table of this machine is beyond the travel along Z.
    """
    direction = f"[axis.Z]\ndirection = [{math.cos(angle):.12f}, 0.0, {math.sin(angle):.12f}]"
    with pytest.raises(BadFile, match="beyond the travel along Z" if spans else "in one plane"):
        read_machine(changed(tmp_path, ("[axis.Z]", direction)))


@pytest.mark.parametrize(
    ("stated", "meant"),
    [
        ("[-1.6406, 0.2793]", "[-94, 16]"),
        ("[-2.0769, 2.0769]", "[-119, 119]"),
        ("[-1.75, 2.25]", None),  # quarters of a degree; 2.25 rad are 129 degrees
        ("[-3.0, 4.5]", None),
        ("[-2.8648, 2.8648]", None),  # 0.05 rad in degrees, a joint of a robot
        ("[-1.63, 0.31]", None),  # -93.4 and 17.8 degrees
    ],
)
def test_whole_degrees_in_radians_are_asked_about(tmp_path, stated, meant):
    path = changed(tmp_path, (B, stated))
    if meant is None:
        read_machine(path)
        return
    words = rf"B\.range: .*is it in radians, {re.escape(meant)}\? .*confirmed = \[\"axis\.B\.range"
    with pytest.raises(BadFile, match=words):
        read_machine(path)
    text = path.read_text(encoding="utf-8")
    path.write_text(f'confirmed = ["axis.B.range"]\n{text}', encoding="utf-8")
    assert read_machine(path).link("B").range[1] == pytest.approx(
        math.radians(literal_eval(stated)[1])
    )


def test_a_missing_point_is_named_before_the_place_of_the_table(tmp_path):
    """The table stands 25 mm beside the line through the machine's origin that is assumed."""
    text = MACHINE.replace(f"point = {PIVOT}", "").replace(ORIGIN, "origin = [25.0, 0.0, -500.0]")
    path = tmp_path / "machine.toml"
    path.write_text(re.sub(r"(?m)^point = .*$", "", text), encoding="utf-8")
    with pytest.raises(BadFile, match=r"axis\.C\.point: found none, .* 25 mm off the table"):
        read_machine(path)
