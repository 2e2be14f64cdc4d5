"""Every example runs, and one number of each is what a hand calculation or a paper says it is."""

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("ex[0-9][0-9]_*.py"))
LONGEST = 60  # lines of an example: one idea

SECOND_ORDER_UM = 1e-3  # 0.1 mrad squared times half a metre of arm is 5 nm; these are smaller
NM_IN_UM = 1e-3
ROUNDING = 1e-9


def load(number: int) -> ModuleType:
    """An example as a module, by its number."""
    (path,) = (ROOT / "examples").glob(f"ex{number:02d}_*.py")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_an_example_is_short_and_silent_on_import(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= LONGEST
    assert callable(load(int(path.stem[2:4])).main)
    assert capsys.readouterr().out == ""


def test_01_the_pitch_of_x_moves_the_tool_point_by_angle_times_arm() -> None:
    # The table has gone to -100 in x and has taken the reference point of X along; the tool point
    # stands at (0, 50, -200 - 160). So x - c = (100, 50, -360) mm, and with r = (0, 1e-5, 0)
    # r x (x - c) = 1e-5 (-360, 0, -100) mm = (-3.6, 0, -1.0) um.
    result = load(1).main()
    hand = [-3.6, 0.0, -1.0]
    np.testing.assert_allclose(result["exact deviation, µm"], hand, atol=SECOND_ORDER_UM)
    np.testing.assert_allclose(result["first order, µm"], hand, atol=ROUNDING)


def test_02_there_are_71_parameters() -> None:
    # D-MT paper: 71. Ours by hand: 6 axes x 6 components = 36; a zero and two squarenesses of each
    # of 3 linear axes, two offsets, two tilts and a zero of each of 3 rotary axes = 9 + 15 = 24;
    # the workpiece 6, the tool 5.
    result = load(2).main()
    assert result["parameters"] == 71 == 36 + 24 + 6 + 5
    assert result["of family COMPONENT"] == 36
    assert result["of family LOCATION"] == 24


def test_03_sensitivities_are_one_or_an_arm_and_the_papers_errors_add_up() -> None:
    result = load(3).main()
    # A translation moves the tool point by itself, at every pose.
    np.testing.assert_allclose(result["S"]["EXX"], 1.0, atol=ROUNDING)
    # The roll of B at X = 0, Z = -200: the tool point is 200 + 160 below the gauge point's zero,
    # the B line 420 below it, so the arm is 60 mm (Y is along the line and does not count).
    middle = len(result["C, deg"]) // 2
    assert result["S"]["EBB"][middle] == pytest.approx(60.0, abs=ROUNDING)
    # Linear errors of 50, 75 and 100 um at the end of X are at right angles to each other, whatever
    # B and C do: sqrt(50^2 + 75^2 + 100^2) = 134.63 um.
    assert result["from X, µm"][-1] == pytest.approx(np.sqrt(18125.0), abs=NM_IN_UM)
    # Two radial errors of 10 um, both sin C, at right angles: 10 sqrt(2) um at C = 90 deg.
    assert result["from C, µm"].max() == pytest.approx(10.0 * np.sqrt(2.0), abs=NM_IN_UM)
