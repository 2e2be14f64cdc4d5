"""What is said of a warming at one place of one axis: 4 µm/K, known from how the file is made."""

import numpy as np
import pytest

import matstd
from matstd.report.laws import law_notes
from matstd.report.run_view import diagnosis_step
from matstd.report.verdict import diagnosis_meaning, part_lines
from matstd.report.words import verdict_sentence

MACHINE = """format = "machine/1"
name = "one axis"
chain = "[w f X t]"
[axis.X]
range = [0.0, 100.0]
"""
HEAD = """# format = "run/1"
# machine = "m.toml"
# probe = { radius_mm = 0.0, length_mm = 0.0 }
# u_um = 0.5
time_s,X_mm,px_mm,py_mm,pz_mm,nx,ny,nz,dev_um,T_room_degC
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drift")
    rng = np.random.default_rng(0)
    (folder / "m.toml").write_text(MACHINE)
    warm = 20.0 + 3.0 * (1.0 - np.exp(-np.arange(200) / 40.0))
    rows = [
        f"{60 * i},50,50,0,0,1,0,0,{round(4.0 * (t - 20.0) + rng.normal(0.0, 0.4)):.0f},{t:.3f}\n"
        for i, t in enumerate(warm)
    ]
    (folder / "drift.csv").write_text(HEAD + "".join(rows))
    return matstd.diagnose(folder / "drift.csv", auto=True)


def test_the_library_stands_before_a_law_that_explains_no_more(found) -> None:
    assert found.laws is not None
    (law,) = found.laws.laws
    assert law.library is not None
    assert law.library.score >= law.score
    name = law.library.effect.name
    said = verdict_sentence(found)
    assert "that the library does not have" not in said
    assert said.index(name) < said.index("Second choice")
    assert "thermal-static(EXX,room)" in said  # the same at every touch
    meaning = diagnosis_meaning(found)
    assert "no effect of the library" not in meaning
    assert name in meaning
    assert f'--add "{name}"' in diagnosis_step(found, "drift.csv")
    assert any("The library explains it better" in note for note in law_notes(found.laws))


def test_a_slope_is_per_kelvin(found) -> None:
    """Deviation 4 µm/K outwards is -4 µm/K of the tool: the slope of numpy over the rows."""
    run = found.run
    slope = np.polyfit(run.touches.temperature["room"], run.deviation * 1e3, 1)[0]
    assert f"{-slope:.2f}" in verdict_sentence(found)
    assert "µm per K over temperature room" in verdict_sentence(found)


def test_repeatability_is_that_of_successive_readings(found) -> None:
    """Rounded to 1 µm: sqrt(0.4^2 + 1/12) µm, four standard deviations of 199 differences."""
    words = dict(part_lines(found))["repeatability"]
    size = float(words.split(" µm in replicates")[0].rsplit(" ", 1)[1])
    assert size == pytest.approx(np.hypot(0.4, 12.0**-0.5), abs=4.0 * 0.5 / np.sqrt(2.0 * 132))


def test_what_cannot_act_is_no_rival(found) -> None:
    """One axis and one normal: no effect of the probe or the standard explains any of it."""
    confusion = found.steps[1].confusion
    assert confusion is not None
    names = [r.effect.name for r in (*confusion.rivals, *confusion.distinguished)]
    assert names
    assert not [name for name in names if name.startswith(("probe-", "stylus-"))]
    assert "odds 1e12" not in dict(part_lines(found))["named effects"]


def test_neighbours_in_what_is_constant_are_not_named(found) -> None:
    assert not [s for s in found.structure if {"py_mm", "pz_mm"} & set(s.variables)]
