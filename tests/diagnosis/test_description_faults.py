"""Mistakes in the description: planted in the text of the files, named with their figures."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_up import made_up
from run_text import every
from simulator_case import read_back, simulate_case

from matstd.cli import main
from matstd.diagnosis.faults import Fault, description_faults, faults_of_refused
from matstd.diagnosis.faults.suspects import recomputed
from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.geometry import learnt_geometry
from matstd.report.geometry import copy_lines, fault_sentences
from matstd.twin.effects import LocationError
from matstd.twin.errors import BadFile
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.record import Run
from matstd.twin.units import UM


@pytest.fixture(scope="module")
def texts():
    """Run file and machine file of an ordinary table-table machine."""
    run, machine, _ = simulate_case(np.random.default_rng(77), "hsm600u", with_alike=False)
    return every(3, run), machine


def faults_in(run, machine):
    try:
        read = read_back(run, machine)
    except BadFile as refusal:
        return faults_of_refused(refusal.facts["run"])
    return description_faults(fit_run(read, ordinary_model(read.touches.chain)))


def test_nothing_is_suspected_of_a_right_description(texts) -> None:
    assert faults_in(*texts) == ()


def test_a_reversed_axis_is_named_though_the_reader_refuses_the_run(texts) -> None:
    run, machine = texts
    turned = machine.replace("[axis.C]\n", "[axis.C]\ndirection = [0.0, 0.0, -1.0]\n")
    (fault,) = faults_in(run, turned)
    assert (fault.fault, fault.axes, fault.alike) == (Fault.AXIS_REVERSED, ("C",), ())
    assert fault.test_rms[0] > 1000.0 * fault.test_rms[1]
    (sentence,) = fault_sentences([fault])
    assert "C moves in the direction opposite to that in the machine file" in sentence
    assert "nothing was changed" in sentence


def test_one_column_in_radians_is_named_alone(texts) -> None:
    run, machine = texts
    head = [line for line in run.splitlines() if line.startswith("#")]
    names, *rows = [line.split(",") for line in run.splitlines()[len(head) :]]
    at = names.index("C_deg")
    for row in rows:
        row[at] = f"{np.radians(float(row[at])):.9f}"
    (fault,) = faults_in("\n".join([*head, *map(",".join, [names, *rows])]) + "\n", machine)
    assert (fault.fault, fault.axes, fault.alike) == (Fault.RADIANS, ("C",), ())


@pytest.mark.parametrize("is_stated", [False, True])
def test_linear_columns_in_inches_are_named(texts, is_stated: bool) -> None:
    """With deviations that the readings contradict, and without any."""
    run, machine = texts
    head = [line for line in run.splitlines() if line.startswith("#")]
    names, *rows = [line.split(",") for line in run.splitlines()[len(head) :]]
    for at in (names.index(f"{axis}_mm") for axis in "XYZ"):
        for row in rows:
            row[at] = f"{float(row[at]) / 25.4:.9f}"
    if is_stated and "dev_um" not in names:
        names = [*names, "dev_um"]
        rows = [[*row, f"{5.0 * (-1) ** i:.1f}"] for i, row in enumerate(rows)]
    (fault,) = faults_in("\n".join([*head, *map(",".join, [names, *rows])]) + "\n", machine)
    assert (fault.fault, set(fault.axes)) == (Fault.INCHES, {"X", "Y", "Z"})
    assert "are inches, not mm" in fault_sentences([fault])[0]


def with_columns(run: str, names: list[str], change) -> str:
    """A run whose columns hold what `change` makes of their numbers, (N, K) to (N, K)."""
    head = [line for line in run.splitlines() if line.startswith("#")]
    header, *rows = [line.split(",") for line in run.splitlines()[len(head) :]]
    at = [header.index(name) for name in names]
    made = change(np.array([[float(row[i]) for i in at] for row in rows]))
    for row, values in zip(rows, made, strict=True):
        for i, value in zip(at, values, strict=True):
            row[i] = f"{value:.9f}"
    return "\n".join([*head, *map(",".join, [header, *rows])]) + "\n"


@pytest.mark.parametrize("pair", [("nx", "ny"), ("nx", "nz"), ("ny", "nz")])
def test_exchanged_columns_of_the_normal_are_named(texts, pair) -> None:
    run, machine = texts
    (fault,) = faults_in(with_columns(run, list(pair), lambda v: v[:, ::-1]), machine)
    assert (fault.fault, fault.axes, fault.alike) == (Fault.AXES_SWAPPED, pair, ())
    assert f"the columns of {pair[0]} and {pair[1]} are exchanged" in fault_sentences([fault])[0]
    assert fault.test_rms[0] > 100.0 * fault.test_rms[1]


@pytest.mark.parametrize(
    ("columns", "factor", "words"),
    [
        (("px", "py", "pz"), 1.0 / 25.4, "px, py and pz are inches, not mm"),
        (("px", "py", "pz"), 25.4, "px, py and pz are 25.4 times too large"),
        (("X", "Y", "Z", "px", "py", "pz"), 1.0 / 25.4, "X, Y, Z, px, py and pz are inches"),
    ],
)
def test_points_in_inches_are_named(texts, columns, factor: float, words: str) -> None:
    run, machine = texts
    named = [f"{column}_mm" for column in columns]
    (fault,) = faults_in(with_columns(run, named, lambda v: factor * v), machine)
    assert (set(fault.axes), fault.alike) == (set(columns), ())
    assert words in fault_sentences([fault])[0]


def test_rotary_axes_in_the_other_order_are_named_with_the_chain(texts) -> None:
    run, machine = texts
    (fault,) = faults_in(run, machine.replace("[w C' B' X'", "[w B' C' X'"))
    assert fault.fault is Fault.ROTARY_ORDER
    assert fault.notation == "[w C' B' X' f Y Z (C1) t]"


@pytest.mark.parametrize(
    ("radius", "change"), [("2.9", 0.1), pytest.param("3.08", -0.08, marks=pytest.mark.slow)]
)
def test_a_ball_radius_comes_back_with_its_sign(texts, radius, change) -> None:
    run, machine = texts
    (fault,) = faults_in(run.replace("radius_mm = 3.0", f"radius_mm = {radius}"), machine)
    assert fault.fault is Fault.BALL_RADIUS
    (number,) = fault.numbers
    assert number.change == pytest.approx(change, abs=4.0 * number.u)
    assert number.u < 0.003


def test_a_tool_length_and_the_point_of_its_tilting_axis_are_not_distinguished(texts) -> None:
    """On a machine that tilts the table about B both move B's line along Z as the tool sees it."""
    run, machine = texts
    (fault,) = faults_in(run.replace("length_mm = 160.0", "length_mm = 161.5"), machine)
    both = {(f.fault, f.axes): f for f in (fault, *fault.alike)}
    assert set(both) == {(Fault.TOOL_LENGTH, ()), (Fault.PIVOT, ("B",))}
    (length,) = both[Fault.TOOL_LENGTH, ()].numbers
    assert length.change == pytest.approx(-1.5, abs=4.0 * length.u)
    assert "either" in fault_sentences([fault])[0]


def test_a_line_wrong_by_a_millimetre_is_named_though_odd_errors_predict_as_well() -> None:
    """Errors half as large again as usual take it up, and predict poses left out as well."""
    run, machine, _ = simulate_case(np.random.default_rng([1, 14]), "hsm600u", with_alike=False)
    wrong = re.sub(r"(\[axis\.B\]\nrange = [^\n]*\npoint = \[)0\.0,", r"\1-1.0,", machine)
    assert wrong != machine
    (fault,) = faults_in(run, wrong)
    assert (fault.fault, fault.axes) == (Fault.PIVOT, ("B",))
    assert fault.numbers[0].name == "EX0B"
    assert fault.numbers[0].change == pytest.approx(1.0, abs=4.0 * fault.numbers[0].u)
    assert fault.widened[0] > 1.2 > fault.widened[1]


@pytest.fixture(scope="module")
def pivot(texts):
    """The line of C stated 2 mm off: the fit, and what is suspected."""
    run, machine = texts
    wrong = re.sub(r"(\[axis\.C\]\nrange = [^\n]*\npoint = )\[[^\]]*\]", r"\1[2.0, 0, 0]", machine)
    assert wrong != machine
    read = read_back(run, wrong)
    fit = fit_run(read, ordinary_model(read.touches.chain))
    return fit, description_faults(fit)


def test_a_pivot_comes_back_with_its_sign(pivot) -> None:
    (fault,) = pivot[1]
    assert (fault.fault, fault.axes) == (Fault.PIVOT, ("C",))
    (number,) = fault.numbers
    assert number.name == "EX0C"
    assert number.change == pytest.approx(-2.0, abs=4.0 * number.u)


def test_of_wrong_columns_no_number_of_the_machine_is_copied(pivot) -> None:
    """The geometry was estimated with them."""
    fit, (fault,) = pivot
    geometry, touches = learnt_geometry(fit), fit.run.touches
    assert any("axis.C" in line for line in copy_lines(touches, geometry, ()))
    columns = replace(fault, fault=Fault.AXES_SWAPPED, axes=("ny", "nz"), numbers=())
    assert copy_lines(touches, geometry, [columns]) == []


def test_the_command_line_names_the_mistake_in_its_refusal(texts, tmp_path, capsys) -> None:
    run, machine = texts
    turned = machine.replace("[axis.B]\n", "[axis.B]\ndirection = [0.0, -1.0, 0.0]\n")
    (tmp_path / "run.csv").write_text(run, encoding="utf-8")
    (tmp_path / "machine.toml").write_text(turned, encoding="utf-8")
    out = tmp_path / "out"
    assert main(["compare", str(tmp_path / "run.csv"), "-o", str(out), "--no-report"]) == 2
    message = capsys.readouterr().err
    assert "B moves in the direction opposite to that in the machine file" in " ".join(
        message.split()
    )
    assert not out.exists()


def test_what_a_found_effect_explains_is_no_mistake_of_the_description(pivot) -> None:
    """A pivot 2 mm off is named, unless something was found that does the same; others stay."""
    fit, _ = pivot
    found = LocationError(fit.model.chain.symbol("EX0C"), 2.0)
    # under a name of its own, as an effect that was found has it
    beside = SimpleNamespace(
        kind="found", name="found", parameters=found.parameters, terms=found.terms
    )
    assert description_faults(fit, beside=[beside]) == ()
    backlash = parse_effect("backlash(X)", fit.model.chain)
    (again,) = description_faults(fit, beside=[backlash])
    assert (again.fault, again.axes) == (Fault.PIVOT, ("C",))


def test_deviations_of_an_instrument_follow_the_readings_that_are_meant() -> None:
    """A reading 20 µm larger of an axis that carries the tool is 20 µm more along that axis."""
    t = made_up("hmc1995", 60)
    run = Run(t, np.random.default_rng(1).normal(0.2, 0.05, 60), np.full(60, UM))
    np.testing.assert_allclose(recomputed(run, t).deviation, run.deviation, atol=1e-12)
    q = t.q.copy()
    q[:, t.chain.axis_index("Y")] += 20.0 * UM
    moved = recomputed(run, replace(t, q=q)).deviation - run.deviation
    flat = t.setup == 0  # its frame is that of the machine
    np.testing.assert_allclose(moved[flat], 20.0 * UM * t.normal[flat, 1], atol=1e-9)
