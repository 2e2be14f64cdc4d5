"""Every example runs, and one number of each is what a hand calculation or a paper says it is."""

import importlib
import sys
from functools import partial
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import matstd
from matstd.diagnosis.answer import Verdict
from matstd.twin.units import UM

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("ex[0-9][0-9]_*.py"))
LONGEST = 60  # lines of an example: one idea

SECOND_ORDER_UM = 1e-3  # 0.1 mrad squared times half a metre of arm is 5 nm; these are smaller
NM_IN_UM = 1e-3
ROUNDING = 1e-9


def load(number: int) -> ModuleType:
    """An example as a module, by its number; examples may import earlier ones."""
    (path,) = (ROOT / "examples").glob(f"ex{number:02d}_*.py")
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    return importlib.import_module(path.stem)


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


def test_04_nine_control_heights_are_a_saddle_of_the_stated_radii() -> None:
    result = load(4).main()
    # h = u^2/120 - v^2/180 has h_uu = 1/60 and h_vv = -1/90, and no slope in the middle.
    np.testing.assert_allclose(
        result["principal radii in the middle, mm"], [60.0, -90.0], atol=ROUNDING * 1e3
    )
    # Its slope at u = 24 mm is u/60 = 0.4, an angle of 21.801 degrees.
    assert result["slope at u = 24 mm, deg"] == pytest.approx(np.degrees(np.arctan(0.4)))
    # Tilted by 40 degrees about y, z becomes (sin 40, 0, cos 40).
    tilt = np.radians(40.0)
    np.testing.assert_allclose(
        result["normal in the middle"], [np.sin(tilt), 0.0, np.cos(tilt)], atol=ROUNDING
    )
    # A ball that starts 10 mm above the surface and comes down along its normal travels 10 mm.
    assert result["travel of the ball, mm"] == pytest.approx(10.0, abs=ROUNDING)


def test_07_the_program_goes_where_two_rotations_by_hand_say() -> None:
    result = load(7).main()
    # The middle of FF3 stands at radius 85, azimuth 120, height 95. The table turns by -C = 60
    # degrees: azimuth 180, so (-85, 0, 95); the line of B is 80 above the table: (-85, 0, 15) from
    # it, and the cradle turns by -B = 50 degrees about y:
    #   x = -85 cos 50 + 15 sin 50 = -43.1463,  z = 80 + 85 sin 50 + 15 cos 50 = 154.7556.
    # The face, tilted by 50 degrees, then looks straight up: the lowest point of the ball starts
    # 5 mm above it.
    assert "L X-43.1463 Y+0.0000 R0 FMAX\n" in _unnumbered(result["text"])
    assert "L Z+159.7556 R0 F2000\nTCH PROBE 4.0" in _unnumbered(result["text"])
    assert "TCH PROBE 4.2 IX+0.0000 IY+0.0000 IZ-1.0000\n" in _unnumbered(result["text"])
    # Five touches for each of five entries; four different poses, each visited twice, and on every
    # visit one touch on the anchor sphere.
    assert len(result["feature"]) == 5 * 5 + 4 * 2


def _unnumbered(text: str) -> str:
    """A program without its block numbers."""
    return "\n".join(line.partition(" ")[2] for line in text.splitlines())


@pytest.mark.slow  # tests/cad_out export another one
def test_06_the_step_file_holds_every_part_and_face_by_name(tmp_path: Path) -> None:
    result = load(6).main(tmp_path)
    assert result["solids"] == 1 + 3 + 4  # body, balls, screws
    assert result["watertight"]
    # 4 faces, 3 balls with their seats, datums A, B, C, the underside, 4 holes with a counterbore
    # each, the pocket for a thermometer.
    assert len(result["named faces"]) == 4 + 3 * 2 + 3 + 1 + 4 * 2 + 1
    # Nothing is fitted on the way to the file: poles and knots are the design's own digits, written
    # with 15 places, so the faces agree to the rounding of coordinates of some 100 mm.
    assert result["largest deviation of a face, µm"] < 1e-6
    # The kernel's volume against a sum over 4 mm cells of the signed distance, which knows no CAD:
    # half a cell over a surface of 0.3 m2 is 600 cm3, and averages out to better than 1 in 1000;
    # seats, pocket and lettering are a thousandth themselves.
    assert result["volume, mm3"] == pytest.approx(
        result["volume by signed distances, mm3"], rel=2e-3
    )
    models = {f"standard{end}" for end in (".step", "-faces.step", ".stl", ".3mf", ".glb")}
    assert {p.name for p in tmp_path.iterdir()} == {*models, "conformity.json"}


@pytest.mark.slow
def test_05_an_ideal_scatter_leaves_what_the_noise_leaves_and_one_face_leaves_more() -> None:
    result = load(5).main()
    left = result["not predicted after 160 touches, µm"]
    # 160 touches of 1 um determine k combinations. Averaged over the touches, what stays unknown
    # along their normals has the variance k/160 um^2 (the trace of the projection). Points and
    # normals at will represent the volume: with three directions sqrt(3 k/160) um, and up to half
    # as much again, because no surface that looks down can be touched.
    scatter = "ideal scatter, chosen by I"
    expected = np.sqrt(3.0 * result["combinations determined"][scatter] / 160.0)
    assert 0.8 * expected < left[scatter] < 1.6 * expected
    # One smooth face holds hardly more than one direction, even at table poses of its own: so
    # it leaves at least twice as much as the standard does, and half as much again as four spheres.
    own, spheres = left["standard FFS"], left["4 spheres"]
    face = left["one freeform face"]
    assert face > 2.0 * own
    assert face > 1.5 * spheres


def test_08_the_residual_is_the_noise_less_what_the_fit_took() -> None:
    result = load(8).main()
    fit, proof = result["fit"], result["proof"]
    # A fit of k effective parameters to N touches of 1 um leaves sqrt(1 - k/N) um rms; over N - k
    # degrees of freedom that scatters by 1/sqrt(2 (N - k)), here 4 %: three times that is allowed.
    n, k = len(fit.run), fit.solution.effective_parameters
    expected = np.sqrt(1.0 - k / n)
    assert fit.rms * 1e3 == pytest.approx(expected, rel=3.0 / np.sqrt(2.0 * (n - k)))
    # The design's own promise: at least ten times less is unpredicted at poses without a touch.
    assert proof.factor > 10.0
    # And no better than the noise allows: touches that represented the volume ideally would leave
    # sqrt(3 k/N) um, as in example 5; less would mean that the truth leaked into the fit.
    assert proof.rms_after * 1e3 > np.sqrt(3.0 * k / n)


@pytest.mark.slow  # tests/diagnosis/test_hidden_effects.py hides the same
def test_09_the_hidden_backlash_is_named_and_the_error_falls_to_the_noise() -> None:
    result = load(9).main()
    assert result["effects"] == ["backlash(C)"]
    # 80 urad were hidden; the estimate must hold them within three of its own uncertainties.
    size = result["size"]
    assert abs(size.value - 80.0) < 3.0 * size.u
    # Held-out touches then show the noise of 1 um, which 468 touches estimate to about 4 %; before,
    # the backlash of +-40 urad at arms of some 60 mm adds 2.4 um times the normals' share of it.
    # another run of these touches would see the noise and what the fit took of it: 6 % here
    assert result["held out, µm"][-1] == pytest.approx(1.0, abs=0.12)
    assert result["held out, µm"][0] > 1.3


@pytest.mark.slow  # the hose of tests/test_examples_diagnosis.py says the same
def test_10_an_effect_of_ones_own_turns_unexplained_into_found() -> None:
    result = load(10).main()
    before, after = result["before"], result["after"]
    assert before.verdict is Verdict.UNEXPLAINED
    assert [effect.name for effect in after.found] == ["clamp-lift"]
    (lift,) = after.steps[-1].reported
    assert abs(lift.value - 5.0) < 3.0 * lift.u  # 5 um were hidden
    # Half the touches have the lift and half have not, which distinguishes it from the mean: each
    # shows it by the cosine n_z between its normal and the axis of C, so u is at least
    # 2 um / sqrt(sum n_z^2), and little more, since no other error knows the side.
    least = 2.0 / np.sqrt(np.sum(after.run.touches.normal[:, 2] ** 2))
    assert 0.95 * least < lift.u < 1.5 * least


def test_11_the_plate_is_as_large_as_drawn_and_tables_hold_what_they_can() -> None:
    found = load(11).main()
    plate = found["plate"]
    # 90 µm in 750 mm of X, 300 of them: the plate is 36 µm longer by that alone
    assert 30 * UM < np.abs(plate.before[:, 0]).max() < 45 * UM
    assert np.linalg.norm(plate.after, axis=1).max() < 0.02 * UM  # two roundings to 10 nm
    left = {name: np.abs(found[name].after).max() for name in ("iso230", "sinumerik")}
    assert left["iso230"] < 0.01 * UM  # linear errors need no points
    assert left["sinumerik"] > 5 * UM  # pitch far from the datum


@pytest.mark.slow  # the run is diagnosed in `test_examples_runs`, tables are written in their room
@pytest.mark.usefixtures("unrendered")
def test_12_the_drift_of_the_machine_of_1995_is_found_and_taken_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # laws of what remains have their own tests, and half the time of a diagnosis
    monkeypatch.setattr(matstd, "diagnose", partial(matstd.diagnose, learn=False))
    result = load(12).main(tmp_path)
    found = result["diagnosis"]
    size, tau = found.steps[-1].reported[:2]
    # 82 µm along Z with 90 min were planted
    assert abs(size.value - 82.0) < 3.0 * size.u
    assert abs(tau.value - 90.0) < 3.0 * tau.u
    assert (tmp_path / "diagnosis" / "report.html").exists()
    # after twice the time constant 86 % of it are there, the same at every pose, which the datum
    # takes up; what is left of linear errors in a table of names is its rounding to 10 nm
    assert 20 * UM < np.abs(result["tables"].before).max() < 400 * UM
    assert np.abs(result["tables"].after).max() < 0.1 * UM


def test_13_the_plate_is_compensated_from_known_errors(tmp_path: Path) -> None:
    result = load(13).main(tmp_path)
    # Chen published 90 µm in the 750 mm of X
    assert np.ptp(result["deviations"][:, 0]) == pytest.approx(90 * UM, rel=1e-3)
    assert np.linalg.norm(result["plate"].after, axis=1).max() < 0.02 * UM
    assert (tmp_path / "plate-compensated.ngc").read_text().count("G1") >= 5
