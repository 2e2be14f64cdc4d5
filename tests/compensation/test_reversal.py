"""What an axis does otherwise after a motion in the other direction, over a workspace."""

from dataclasses import dataclass

import numpy as np
import pytest
from bench import LENGTH, part_program

from matstd.compensation.field import MachineErrors, in_both_directions, sample_workspace
from matstd.compensation.programs.path import ProgramPath
from matstd.compensation.tables import FORMATS, verify_tables, write_tables
from matstd.report.compensation import table_lines
from matstd.twin.library import parse_effect
from matstd.twin.model import Declared
from matstd.twin.numbers import rms_length as rms
from matstd.twin.units import UM

SIZES = {"geometric(EXX,linear)": 30 * UM, "geometric(EYX,parabolic)": 20 * UM}
REVERSALS = {"backlash(X)": 4 * UM, "backlash(Y)": 6 * UM}


def errors_of(chain, sizes):
    return MachineErrors.of_errors(
        chain, [(parse_effect(name, chain), np.array([a])) for name, a in sizes.items()]
    )


@pytest.mark.parametrize("name", FORMATS)
def test_a_reversal_remains_with_tables_that_do_not_hold_it(
    name, bench_chain, datum, head, poses, tmp_path
):
    """Half of 4 um along X and half of 6 um along Y, either sign, on top of all else."""
    found = {}
    for key, sizes in {"without": SIZES, "with": SIZES | REVERSALS}.items():
        errors = errors_of(bench_chain, sizes)
        write_tables(FORMATS[name], tmp_path / key / name, errors, datum, head, poses)
        found[key] = verify_tables(FORMATS[name], tmp_path / key / name, errors, datum, head, poses)
    plain, result = found["without"].result, found["with"].result
    halves = np.hypot(2 * UM, 3 * UM)
    left = 0.0 if name == "linuxcnc" else halves
    np.testing.assert_allclose(rms(result.before), np.hypot(rms(plain.before), halves), rtol=1e-3)
    np.testing.assert_allclose(rms(result.after), np.hypot(rms(plain.after), left), rtol=5e-3)
    rows = {row.name: row for row in result.left}
    for axis, half in {"X": 2 * UM, "Y": 3 * UM}.items():
        row = rows[f"backlash({axis})"]
        np.testing.assert_allclose(row.before, half, rtol=1e-3)
        np.testing.assert_allclose(row.rms, half if left else 0.0, rtol=1e-3, atol=1e-9)
    said = list(table_lines(found["with"]))
    assert f"{len(poses)} poses in both directions" in said[0]
    assert any("backlash(Y) (3.00 of 3.00 µm remain)" in line for line in said) == bool(left)
    assert "in both directions" not in next(table_lines(found["without"]))


def test_reversals_of_several_axes_are_judged_apart(bench_chain):
    """Every pose after motions of both directions; two axes meet with equal and opposite signs."""
    errors, poses = errors_of(bench_chain, REVERSALS), sample_workspace(bench_chain, {})
    touches = in_both_directions(errors, poses, LENGTH)
    first, second = np.split(touches.approach, 2)
    assert np.array_equal(first, -second)
    assert set(np.unique(first)) == {-1.0, 1.0}
    every = np.corrcoef(np.column_stack([first, poses[:, :5]]).T)
    assert np.abs(every - np.eye(len(every)))[: first.shape[1]].max() < 0.2
    assert len(in_both_directions(errors_of(bench_chain, SIZES), poses, LENGTH)) == len(poses)


@dataclass(frozen=True)
class Wedge(Declared):
    """A straightness whose reversal grows from nothing in the middle of the travel."""

    kind, acts_on = "wedge", "EYX"

    def amounts(self, touches):
        return (touches.last_move("X") * touches.reading("X") / 100.0,)


def test_a_program_feels_a_reversal_that_is_none_at_zero(bench_chain, frame, tmp_path):
    program = part_program(
        "BEGIN PGM A MM\nL X+0 Y+0 Z+0 F MAX\nL X+50 F500\nEND PGM A MM\n", frame, tmp_path
    )
    errors = MachineErrors.of_errors(bench_chain, [(Wedge(), np.array([5 * UM]))])
    assert ProgramPath(program, errors).last is not None
    assert ProgramPath(program, errors_of(bench_chain, SIZES)).last is None
