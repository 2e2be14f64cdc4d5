"""Logs: written through the masks as the control would, read back, evaluated."""

from dataclasses import replace
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from programs import parts_of, ran
from unchanged import facts

from matstd.artefact.body import Known
from matstd.probe_paths.campaign import VirtualMachine, evaluate
from matstd.probe_paths.campaign.contact_solver import FIRST_MORNING
from matstd.probe_paths.campaign.log_parts import distinct_parts
from matstd.probe_paths.campaign.virtual_run import run_programs
from matstd.probe_paths.control import read_log
from matstd.probe_paths.language import Dialect, MaskLine, parse_mask
from matstd.twin.effects import ComponentError
from matstd.twin.errors import BadFile, DesignError, NotEnoughData
from matstd.twin.files import read_run, write_run
from matstd.twin.frames import pose, rotation
from matstd.twin.model import contribution
from matstd.twin.record import computed_deviation
from matstd.twin.rows import picked
from matstd.twin.units import NM, UM, URAD

PRINTED = 1e-6
"""Six decimals of a log, mm; a deviation adds three of them and those of a foot point."""

U = 1.0 * UM
STANDS = pose(rotation(np.array([1e-4, -2e-4, 5e-4])), np.array([0.08, -0.05, 0.03]))
"""Of the standard, beside its place."""


@pytest.fixture(scope="module")
def runs(read, small, chain):
    """The golden programs on a machine with noise that stands beside its place."""
    machine = VirtualMachine(chain, setup_error=STANDS, noise=0.5 * UM)
    return run_programs(read, small, machine, np.random.default_rng(2))


@pytest.fixture(scope="module")
def parts(runs, chain):
    return parts_of(runs, chain)


def test_a_mask_is_filled_in_as_the_control_does():
    line = MaskLine("P%6.1LF X%11.4LF N%3d T%3d:%3d", (1620, 1610, 1621, "HOUR", "YEAR4"))
    values = {1620: 7.0, 1610: -12.34567, 1621: 3.0}
    filled = line.filled(values, datetime(2031, 5, 6, 7, 8, 9))
    assert filled == "P   7.0 X   -12.3457 N  3 T  7:2031"
    assert parse_mask('"A%3d",Q1;\r\n"B";\r\n', "M.A") == (
        MaskLine("A%3d", (1,)),
        MaskLine("B", ()),
    )


def test_logs_hold_what_the_machine_did(runs, parts, read, chain):
    for run, part, program in zip(runs, parts, read, strict=True):
        assert part.is_complete
        assert part.program == program.name
        assert part.number.tolist() == [t.number for t in program.touches]
        assert part.pose.tolist() == [t.pose for t in program.touches]
        assert part.feature.tolist() == [t.feature for t in program.touches]
        assert (part.radius, part.tool_length) == (3.0, 163.0)
        x = part.xyz[:, 0]
        assert np.abs(x - run.q[:, chain.axis_index("X")]).max() < PRINTED
        b = np.radians(part.rotary["B"])
        assert np.abs(b - run.q[:, chain.axis_index("B")]).max() < 1e-9
        clock = (part.begin - FIRST_MORNING).total_seconds() + part.time
        assert np.all(np.floor(run.time) == clock)


def test_runs_logs_and_evaluation_are_what_they_were(runs, parts, small, chain, unchanged):
    made = [(r.q, r.time, r.feature, r.meeting, r.reached, r.outcome, r.end) for r in runs]
    unchanged("\n".join([facts(made), facts(parts), facts(evaluate(parts, small, chain, U))]))


def test_two_logs_of_one_run_give_every_touch_once(parts):
    """One cut off at its end, the other one without its beginning."""
    one = parts[0]
    n = len(one.number)
    head, tail = picked(one, np.arange(n - 2)), picked(one, np.arange(4, n))
    found = distinct_parts([tail, head])
    assert [len(part.number) for part in found] == [n - 2, 2]
    assert np.array_equal(np.concatenate([part.number for part in found]), one.number)
    assert f"{n - 6} touches stand in {one.path} too" in found[1].remarks[-1]


def test_z_is_that_of_the_gauge_point_and_x_y_those_of_the_ball(parts, runs, chain):
    """Machine convention: table origin at Z = -500 and the probe's length not taken off."""
    z = runs[0].q[:, chain.axis_index("Z")] + 500.0
    assert np.abs(parts[0].xyz[:, 2] - z).max() < PRINTED


def test_the_other_meaning_of_z_is_a_dialect(read, small, chain, runs):
    words = Dialect(result_height="tip")
    machine = VirtualMachine(chain, setup_error=STANDS, noise=0.5 * UM, dialect=words)
    part, gauge = parts_of([ran(read[0], small, machine, seed=2), runs[0]], chain)
    assert np.abs(gauge.xyz[:, 2] - part.xyz[:, 2] - 163.0).max() < 2.0 * PRINTED
    good = evaluate([part], small, chain, U, words)
    assert np.abs(good.deviation).max() < 3.0 * UM
    with pytest.raises(DesignError, match="meaning of Z"):
        evaluate([part], small, chain, U)


def test_the_set_up_is_found_and_deviations_are_the_noise(parts, small, chain, runs, read):
    run = evaluate(parts, small, chain, U)
    true = read[0].heading.setup.T_table_artefact @ STANDS
    found = run.touches.setups[0].T_table_artefact
    assert np.abs(found - true)[:3, 3].max() < 1.5 * UM
    assert np.abs(found - true)[:3, :3].max() < 30.0 * URAD
    drawn = np.random.default_rng(2)
    noise = np.concatenate([drawn.normal(0.0, 1.0, len(p.touches)) for p in read]) * 0.5 * UM
    # six parameters of the set-up take up some of the noise, the rest is left as drawn
    left = run.deviation - noise
    assert np.sqrt(np.mean(left**2)) < 0.5 * UM * np.sqrt(10.0 / len(run))
    assert np.abs(np.linalg.norm(run.touches.normal, axis=1) - 1.0).max() < 1e-12


def evaluated(read, small, machine):
    """The run of all programs on a machine."""
    runs = run_programs(read, small, machine, np.random.default_rng(0))
    return evaluate(parts_of(runs, machine.chain), small, machine.chain, U)


def test_without_errors_nothing_is_left_but_the_digits_of_the_log(read, small, perfect):
    run = evaluated(read, small, perfect)
    assert np.abs(run.deviation).max() < 1.0 * NM
    assert np.abs(run.deviation - computed_deviation(run.touches)).max() < 1e-3 * NM


def test_a_log_read_back_through_a_run_file_is_the_same_run(parts, small, chain, tmp_path):
    run = evaluate(parts, small, chain, U)
    write_run(tmp_path / "run.csv", run, "machine.toml")
    back = read_run(tmp_path / "run.csv", chain)
    assert back.remarks == ()
    assert np.abs(back.deviation - run.deviation).max() < 2.0 * NM
    assert np.abs(computed_deviation(back.touches) - run.deviation).max() < 3.0 * NM
    assert back.touches.feature.tolist() == run.touches.feature.tolist()
    assert np.array_equal(back.touches.approach, run.touches.approach)
    assert np.array_equal(back.touches.pose, run.touches.pose)
    assert np.abs(back.touches.time - run.touches.time).max() < 1e-9
    again = evaluate(parts[::-1], small, chain, U)
    assert np.array_equal(again.deviation, run.deviation)


def test_a_tangential_offset_of_the_set_up_is_not_taken_for_a_deviation(read, small, chain):
    """Half a millimetre beside its place the curved faces would deviate by many µm."""
    beside = pose(t=np.array([0.5, -0.4, 0.3]))
    run = evaluated(read, small, VirtualMachine(chain, setup_error=beside))
    assert np.abs(run.deviation).max() < 2.0 * NM


def test_too_few_touches_for_a_set_up_leave_it_where_it_was_believed(parts, small, chain):
    rows = np.arange(3)
    fields = ("line", "number", "pose", "feature", "xyz", "time")
    short = replace(
        parts[0],
        **{k: getattr(parts[0], k)[rows] for k in fields},
        rotary={a: v[rows] for a, v in parts[0].rotary.items()},
        side={a: v[rows] for a, v in parts[0].side.items()},
    )  # fmt: skip
    run = evaluate([short], small, chain, U)
    moved = run.touches.setups[0].T_table_artefact - parts[0].heading.setup.T_table_artefact
    assert np.abs(moved[:3, 3]).max() < 0.5
    assert np.abs(run.deviation).max() < 0.1 * UM


def test_the_clock_passes_midnight(runs, chain):
    text = runs[0].log["MS_A_1.TXT"].replace("T  8:  ", "T 23: 5").replace("T 23: 5", "T 23: 5", 1)
    lines = text.splitlines()
    late = [i for i, line in enumerate(lines) if line.startswith("T 23")]
    for i in late[len(late) // 2 :]:
        lines[i] = "T  0:  7:  1"
    lines[-1] = "END T  0:  8:  0"
    part = read_log("L", chain.rotary_axes, "\n".join(lines) + "\n")[0]
    assert np.all(np.diff(part.time) >= 0.0)
    assert 400.0 < part.time[-1] < 3600.0


def test_touches_that_cannot_be_evaluated_are_named(parts, small, golden, chain):
    wrong = replace(parts[0], feature=np.full(len(parts[0].feature), 9))
    with pytest.raises(BadFile, match="feature 9, expected 1 to 6"):
        evaluate([wrong], small, chain, U)
    swapped = np.where(parts[0].feature == 3, 4, 3)
    with pytest.raises(DesignError, match=r"touch 1 with .* between ball"):
        evaluate([replace(parts[0], feature=swapped)], small, chain, U)
    other_probe = replace(parts[1], radius=parts[1].radius + 0.1)
    with pytest.raises(BadFile, match="one calibration a probe"):
        evaluate([parts[0], other_probe], small, chain, U)
    elsewhere = replace(
        parts[1], heading=replace(parts[1].heading, setup=replace(
            parts[1].heading.setup, T_table_artefact=np.eye(4)))
    )  # fmt: skip
    with pytest.raises(BadFile, match="one place for each set-up name"):
        evaluate([parts[0], elsewhere], small, chain, U)
    other = golden.standard((golden.sphere("SPH9", 0.0, 0.0),))
    with pytest.raises(DesignError, match=r"written for another design of SMALL-1 "):
        evaluate(parts, other, chain, U)
    other = replace(other, known=Known("cmm.csv", small.fingerprint, {}))
    with pytest.raises(BadFile, match="expected 1 to 2, a feature of SMALL-1"):
        evaluate([replace(parts[0], feature=np.full(len(parts[0].feature), 3))], other, chain, U)
    first = small.spheres[0]
    moved = replace(first, centre=np.add(first.centre, [0.005, 0.0, 0.0]))
    another = replace(small, spheres=(moved, *small.spheres[1:]))
    with pytest.raises(DesignError, match=r"written for another design of \S+ \(\w{12}\); you"):
        evaluate(parts, another, chain, U)
    found = replace(another, known=Known("cmm.csv", small.fingerprint, {}))
    assert len(evaluate(parts, found, chain, U)) == len(evaluate(parts, small, chain, U))
    with pytest.raises(NotEnoughData, match="no touch"):
        evaluate([], small, chain, U)


def test_an_error_of_the_machine_stays_in_the_deviations(read, small, chain):
    """EXX linear, 100 µm over 400 mm: far more than a set-up can hide."""
    effect = ComponentError(chain.symbol("EXX"), "linear")
    machine = VirtualMachine(chain, lambda t: contribution([(effect, np.array([0.1]))], t))
    assert np.sqrt(np.mean(evaluated(read, small, machine).deviation ** 2)) > 2.0 * UM


def _as_control(masks, prints, adds_without_word):
    """File of a control, run by run, by the words of its masks alone: a model of its own.

    Args:
        prints: Names of masks in the order of FN 16, by run.
        adds_without_word: Whether a run adds to an old file where no mask asks for it.
    """
    file = []
    for run in prints:
        is_open = False
        for name in run:
            rows = masks[name].split("\r\n")
            if not is_open and not adds_without_word and "M_APPEND;" not in rows:
                file = []
            is_open = True
            file += [f"{name}:{row}" for row in rows if row and not row.startswith("M_")]
            is_open = "M_CLOSE;" not in rows
    return file


@pytest.mark.parametrize("adds_without_word", [True, False])
def test_a_second_run_replaces_no_log(adds_without_word):
    """Whatever FN 16 does by itself, the words of the masks make the file whole."""
    folder = Path(__file__).parents[1] / "golden" / "programs"
    masks = {path.name: path.read_bytes().decode("ascii") for path in folder.glob("*.A")}
    head = "MS_A_1.A"
    whole = [head, "MSPOINT.A", "MSPOINT.A", "MSEND.A"]
    missed = [head, "MSPOINT.A", "MSMISS.A"]
    once = _as_control(masks, [whole], adds_without_word)
    for first in (whole, missed):
        file = _as_control(masks, [first, whole], adds_without_word)
        assert file[-len(once) :] == once
        assert len(file) > len(once)
        assert sum("MATSTD LOG 1" in line for line in file) == 2


def _in_inches(part):
    return replace(part, xyz=part.xyz / 25.4)


def _mirrored(part, i):
    return replace(part, xyz=part.xyz * np.where(np.arange(3) == i, -1.0, 1.0))


@pytest.mark.parametrize(
    ("mistake", "said"),
    [
        (_in_inches, "the readings of X, Y and Z are in inches"),
        (lambda part: _mirrored(part, 1), "Y moves in the direction opposite"),
        (lambda part: _mirrored(part, 0), "X moves in the direction opposite"),
        (
            lambda part: replace(part, rotary={**part.rotary, "B": -part.rotary["B"]}),
            "B moves in the direction opposite",
        ),
    ],
)
def test_a_mistake_of_a_whole_log_is_named(parts, small, chain, mistake, said):
    with pytest.raises(BadFile, match=f"such of .*, expected less than 10 mm: {said}"):
        evaluate([mistake(part) for part in parts], small, chain, U)
