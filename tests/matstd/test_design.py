"""The main job on a small project: every file is there, and the proof holds."""

import csv
import json
import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rs274
from browser import faults, opened, requests
from commands import steps_of_work
from figures import render_alone
from standards import kernel_here
from unchanged import Unchanged, facts, folded, page_text

from matstd.artefact.body import Limits, read_standard
from matstd.artefact.brief import Brief, PlacementOptions, project_file, read_project
from matstd.artefact.compare import comparison
from matstd.artefact.place import identifying
from matstd.artefact.worth import CriterionOptions, TouchOptions, ball_choice, touch_curve
from matstd.artefact.worth.touch_criterion import CRITERIA
from matstd.cad_out.verify.conformity import FACE_LIMIT
from matstd.cli import main
from matstd.probe_paths.control import read_program
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.language import read_dialect
from matstd.probe_paths.linuxcnc import shortened
from matstd.report.pages import design_page
from matstd.stages import study_run
from matstd.twin.errors import BadFile
from matstd.twin.files import read_errors, read_machine, read_run
from matstd.twin.frames import apply, inverse
from matstd.twin.machine import exact_tip, tip
from matstd.twin.model import contribution
from matstd.twin.record import at_poses
from matstd.twin.units import UM, URAD

NEXT_TO_NONE = "0.01"
"""Noise of a simulation, µm: without any, repeated touches would count as copied rows."""

EXAMPLES = Path(__file__).parents[2] / "examples"


def small_project(folder: Path, machines: int = 1, touches: int = 120, poses: int = 10) -> Path:
    """The example project with fewer poses, draws and touches."""
    (folder / "machine.toml").write_text((EXAMPLES / "hsm600u-machine.toml").read_text())
    (folder / "task.toml").write_text((EXAMPLES / "task.toml").read_text())
    text = (EXAMPLES / "hsm600u.toml").read_text()
    for old, new in (
        ("hsm600u-machine.toml", "machine.toml"),
        ("poses = 2000", "poses = 300"),
        ("draws = 2000", "draws = 300"),
        ("patches = 6 ", "patches = 3 "),
        ("# balls = 13", "balls = 4"),
        ("# proof_touches = 110", "proof_touches = 40"),
        ("touches = 480", f"touches = {touches}"),
        ("poses = 30 ", f"poses = {poses} "),
        ("machines = 3", f"machines = {machines}"),
        ("# visits = 10", "visits = 2"),
    ):
        assert old in text
        text = text.replace(old, new)
    path = folder / "project.toml"
    path.write_text(text)
    return path


def with_few_sites(**fields: object) -> Brief:
    """The brief of a project for which fewer places of faces are tried."""
    made = Brief(**fields)
    return replace(made, options=replace(made.options, sites=20))


@pytest.fixture(scope="module")
def figures() -> dict[str, str]:
    """What the figures of the design consist of, and what its progress says."""
    return {}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory, figures: dict[str, str]) -> Path:
    """The whole command with fewer candidates, one rival of spheres, one of another shape, no maps
    but the path.

    `make proof` has them all; maps are those of `matstd sensitivity`, which has its own test.
    """
    folder = tmp_path_factory.mktemp("design")
    out = folder / "out"
    with pytest.MonkeyPatch.context() as patch:
        kernel_here(patch)
        patch.setattr(project_file, "Brief", with_few_sites)
        patch.setattr(ball_choice, "_PLACES", 30)
        patch.setattr(identifying, "_MAX_REDRAWS", 1)
        patch.setattr(comparison, "COUNTS", (4,))
        bodies = comparison.rivals
        patch.setattr(comparison, "rivals", lambda *of: dict([*bodies(*of).items()][:1]))
        patch.setattr("matstd.cad_out.verify.export.mesh_chord", lambda _: 0.05)
        # `report/test_*` render them; the drawing is no PNG
        recorded, steps = render_alone(patch), steps_of_work(patch)
        patch.setattr(study_run, "draw_maps", lambda *_: [])
        patch.setattr(design_page, "draw_study_volumes", lambda *_: [])
        patch.setattr(design_page, "touch_curve", partial(touch_curve, counts=(50, 150)))
        project = small_project(folder, touches=100, poses=8)
        assert main(["design", str(project), "-o", str(out)]) == 0
    figures |= recorded | {"steps of the work": "\n".join(steps)}
    return out


@pytest.mark.parametrize(
    "names",
    [
        "*.toml",
        "*.json",
        "*.csv",
        "sensitivity/*.csv",
        "sensitivity/montecarlo.json",
        "programs/*",
        "setup/MS*",
        "setup/*.html",
        "report.html",
        "cmm.dmi",
        "drawing.svg",
    ],
)
def test_a_design_is_what_it_was(made: Path, unchanged: Unchanged, names: str) -> None:
    """All that is written as text, lines of the same words in one."""
    unchanged("\n\n".join(f"{p.name}\n{folded(lines_of(p))}" for p in sorted(made.glob(names))))


def lines_of(path: Path) -> str:
    """A file as lines that can be compared: without the shares of effects that rounding decides,
    every vertex of a drawing with its style."""
    versions = r"(?<=material-standard )\d[^<\n]*?(?=<| -->|$)"
    text = re.sub(versions, "", path.read_text(encoding="utf-8"))
    match path.suffix:
        case ".json":  # a freedom of many members has other ones that are as short
            return re.sub(r'\n *"[^"\n]*( [+-] [^"\n]*){5,}",?', "", text)
        case ".html":
            return re.sub(r"\d+ of 72\b", "some of 72", page_text(text))
        case ".dmi":
            return re.sub(r"_\d+\)", ")", text)
        case ".svg":
            paths = re.findall(r'<path d="([^"]*)".*?style="([^"]*)"', text, flags=re.DOTALL)
            lines = [f"{style} {line}" for shape, style in paths for line in shape.splitlines()]
            return "\n".join([*re.findall("<!-- .* -->|<g transform=.*", text), *lines])
    return text


def test_its_figures_are_what_they_were(
    made: Path, figures: dict[str, str], unchanged: Unchanged
) -> None:
    unchanged("\n".join(f"{name}: {figures[name]}" for name in sorted(figures)))


def test_every_file_is_there(made: Path) -> None:
    names = {str(p.relative_to(made)) for p in made.rglob("*") if p.is_file()}
    for name in (
        "standard.toml",
        "standard.step",
        "standard-faces.step",
        "standard.stl",
        "standard.3mf",
        "standard.glb",
        "drawing.pdf",
        "drawing.svg",
        "conformity.json",
        "making.json",
        "run.csv",
        "identification.json",
        "uncertainty.json",
        "cmm.dmi",
        "identifiability.json",
        "report.html",
        "setup/setup.html",
        "errors.toml",
        "machine.toml",
        "sensitivity/poses.csv",
        "sensitivity/sensitivity.csv",
        "sensitivity/shares.csv",
    ):
        assert name in names, name
    assert any(re.fullmatch(r"programs/\w+\.H", n) for n in names)
    assert any(re.fullmatch(r"programs/\w+\.A", n) for n in names)
    assert any(re.fullmatch(r"sensitivity/\w+\.png", n) for n in names)
    assert [p.name for p in made.parent.iterdir() if p.name.startswith(".")] == []


@pytest.mark.browser
def test_the_report_moves(made: Path, browser: Any) -> None:
    """Features, touches, other artefacts, the cut and sensitivities, in a browser."""
    opened(browser, made / "report.html")
    do = browser.execute_script
    assert do("return !document.getElementById('design').hidden")
    standard = read_standard(made / "standard.toml")
    names = {*(p.name for p in standard.patches), *(s.name for s in standard.spheres)}
    assert set(do("return designPage.data.features.map(f => f.name).filter(Boolean)")) == names
    ball = standard.spheres[0].name
    do(f"designPage.choose('{ball}')")
    assert "worth" in do("return document.getElementById('feature').textContent")
    # pointed at where it is drawn
    found = do(
        """const { standard, data } = designPage, view = standard.view;
        view.camera.tilt = 1.5; view.draw();
        const [x, y] = view.project(arguments[0]);
        return standard.under(x, y);""",
        (standard.spheres[0].centre + standard.spheres[0].radius * np.eye(3)[2]).tolist(),
    )
    assert found == ball
    # at every touch the ball of the probe touches the point
    rows = do(
        """const t = designPage.data.touches, n = t.feature.values.length;
        return [[...t.point.values], [...t.normal.values], [...t.tool.values], n,
          designPage.data.length];"""
    )
    point, normal = (np.reshape(v, (-1, 3)) for v in rows[:2])
    tool, length = np.reshape(rows[2], (-1, 4, 3)), rows[4]
    ball_centre = tool[:, 3] - length * tool[:, 2]
    radius = np.linalg.norm(ball_centre - point, axis=1)
    assert np.ptp(radius) < 1e-3
    assert np.abs(ball_centre - point - radius[:, None] * normal).max() < 1e-3
    do(
        """const t = document.getElementById("touch");
        t.value = 3; t.dispatchEvent(new Event("input"));"""
    )
    assert "Touch 3 on" in do("return document.getElementById('touched').textContent")
    # the cut: what identification leaves is smaller, and said
    before = do("return document.getElementById('of-field').textContent")
    do("document.getElementById('after').click()")
    after = do("return document.getElementById('of-field').textContent")
    sizes = [float(re.search(r": ([\d.]+) µm rms", words)[1]) for words in (before, after)]
    assert sizes[0] > 5.0 * sizes[1]
    field = do("const f = designPage.data.field; return { ...f, before: [...f.before.values] }")
    chain = read_machine(made / "machine.toml")
    q = np.zeros((1, len(chain.axes)))
    for axis, places in zip(field["axes"], field["at"], strict=True):
        q[0, chain.axis_index(axis)] = places[2]
    for axis, reading in field["rotary"][1].items():
        q[0, chain.axis_index(axis)] = np.radians(reading)
    errors = contribution(read_errors(made / "errors.toml", chain), at_poses(chain, q, length))
    stands = read_project(made.parent / "project.toml").setup.T_table_artefact
    believed = read_run(made / "run.csv").touches.setups[0].T_table_artefact
    actual = apply(inverse(stands), exact_tip(chain, q, length, errors))
    moved = actual - apply(inverse(believed), tip(chain, q, length))
    counts = [len(places) for places in field["at"]]
    # axes that read as much more would stand where the machine really does
    shown = np.reshape(field["before"], (-1, *counts, 3))[1, 2, 2, 2]
    there = q.copy()
    there[0, [chain.axis_index(axis) for axis in field["axes"]]] += shown * UM
    moved_so = apply(inverse(believed), tip(chain, there, length) - tip(chain, q, length))
    moved_so -= apply(inverse(believed), np.zeros(3))
    assert moved_so == pytest.approx(moved, abs=0.01 * UM)
    # the same as an arrow on the plane
    drawn = do(
        """const { field, data } = designPage, cut = designPage.cut(), at = data.field.at;
        Object.assign(field, { axis: 2, rotary: 1, place: at[2][2], isAfter: false, stretch: 3 });
        document.getElementById("stretch").value = Math.log10(3);
        document.getElementById("stretch").dispatchEvent(new Event("input"));
        const from = at.map(a => a[2]), { positions } = cut.arrows;
        for (let i = 0; i < positions.length; i += 6) {
          if (from.every((v, k) => Math.abs(v - positions[i + k]) < 1e-3)) {
            return [...positions.subarray(i, i + 6), cut.view.camera.size];
          }
        }"""
    )
    arrow = np.array(drawn[3:6]) - drawn[:3]
    assert arrow / np.linalg.norm(arrow) == pytest.approx(shown / np.linalg.norm(shown), abs=1e-3)
    most = np.nanquantile(np.linalg.norm(np.reshape(field["before"], (-1, 3)), axis=1), 0.98)
    share = np.linalg.norm(shown) / most
    assert np.linalg.norm(arrow) == pytest.approx(3.0 * 0.11 * share * drawn[6], rel=0.02)
    # another artefact in place of the standard, then the standard again
    do("document.querySelectorAll('#rivals input')[1].click()")
    assert not do("return designPage.standard.own[0].isVisible")
    do("document.querySelectorAll('#rivals input')[0].click()")
    assert do("return designPage.standard.own[0].isVisible")
    stated = do(
        """return [...document.querySelectorAll("#sensitivities li")].map(
          e => [e.children[0].textContent, parseFloat(e.querySelector("output").textContent)]);"""
    )
    assert dict(map(tuple, stated))["EXX"] == 1.0
    assert faults(browser) == []
    assert requests(browser) == []


def test_the_unpredicted_error_falls_tenfold(made: Path) -> None:
    proof = json.loads((made / "identification.json").read_text())["volumetric_error"]
    for machine in proof:
        assert machine["times_smaller"] > 10.0
        # the poses share some eighty parameters: the share of one machine scatters, their mean is
        # what `make proof` tests
        assert machine["within_2u"] > 0.75


def test_the_run_can_be_made_again_from_the_files(made: Path, tmp_path: Path) -> None:
    """What the page proves, a user can repeat: the same programs, standard, machine, errors."""
    programs = sorted(str(p) for p in (made / "programs").glob("*.H"))
    again = tmp_path / "again.csv"
    arguments = ["--standard", str(made / "standard.toml"), "--machine", str(made / "machine.toml")]
    arguments += [
        "--errors",
        str(made / "errors.toml"),
        "--noise-um",
        NEXT_TO_NONE,
        "-o",
        str(again),
    ]
    assert main(["simulate", *programs, *arguments]) == 0
    first, second = read_run(made / "run.csv"), read_run(again)
    assert len(first) == len(second)
    difference = (first.deviation - second.deviation) * 1e3
    # the datum balls by which the first run was placed had noise, too: a rigid motion between them
    point, normal = first.touches.point, first.touches.normal
    motion = np.column_stack([normal, np.cross(point, normal)])
    left = difference - motion @ np.linalg.lstsq(motion, difference, rcond=None)[0]
    assert 0.8 < np.sqrt(left @ left / (len(left) - 6)) < 1.2  # the noise of the first run, 1 um


def test_what_was_measured_stands_with_its_limits(made: Path) -> None:
    saved = json.loads((made / "conformity.json").read_text())
    assert saved["faults"] == []
    assert 0.0 < saved["measured"]["mass"] < 60.0
    assert saved["limits"]["face_deviation_mm"] == FACE_LIMIT


def test_the_page_stands_alone(made: Path) -> None:
    page = (made / "report.html").read_text(encoding="utf-8")
    assert "http://" not in page
    assert "https://" not in page
    assert page.count("data:image/png;base64,") >= 7
    assert "placeholders" in page
    stated = re.search(r"the (\d+) proving touches take (\d+) minutes, or (\d+) with each", page)
    touches, minutes, once = map(int, stated.groups())
    with next(made.glob("tables/05-*.csv")).open(encoding="utf-8") as table:
        assert 0 < once <= minutes < max(float(way["minutes"]) for way in csv.DictReader(table))
    run = read_run(made / "run.csv").touches
    assert touches == sum(name.startswith("FF") for name in run.feature)


def test_a_design_is_not_overwritten(made: Path, capsys: pytest.CaptureFixture[str]) -> None:
    project = str(made.parent / "project.toml")
    before = (made / "report.html").stat().st_mtime_ns
    assert main(["design", project, "-o", str(made)]) == 2
    assert "--force" in capsys.readouterr().err
    assert (made / "report.html").stat().st_mtime_ns == before


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('"machine.toml"', '"none.toml"', "none.toml"),
        ("X = [-150.0, 150.0]", "X = [150.0, -150.0]", "workspace.X"),
        ("X = [-150.0, 150.0]", "Q = [-150.0, 150.0]", "workspace.Q"),
        ("X = [-150.0, 150.0]", "X = [-900.0, 150.0]", "within the travel"),
        ("patches = 3", "patches = 2", "standard.patches"),
        ("noise_um = 1.0", "noise_um = nan", "simulation.noise_um"),
        ("noise_um = 1.0", "noises = 1.0", "simulation.noises"),
        ("# [errors.classes]", "[errors.classes]\nspeed = [1.0, 2.0]", "errors.classes.speed"),
        ("# [errors.parameters]", "[errors.parameters]\nEQQ = [1.0, 2.0]", "EQQ"),
        ("# [errors.parameters]", "[errors.parameters]\nEXX = [3.0, 2.0]", "smaller first"),
        ("[simulation]", "[simulation", "TOML"),
        ('criterion = "I"', 'criterion = "C"', "standard.criterion"),
        ("potential = 0.3", "potential = 1.0", "standard.potential"),
        ("potential = 0.3", "potential = -0.1", "standard.potential"),
        ("robust_machines = 0", "robust_machines = 2.5", "standard.robust_machines"),
        ("robust_machines = 0", "robust_machines = -1", "standard.robust_machines"),
        ("robust_share = 1.0", "robust_share = 0.0", "standard.robust_share"),
        ("robust_share = 1.0", "robust_share = 0.25", "robust_machines = 0"),
        ("poses = 10 ", "poses = 4 ", "standard.poses"),
        ("touches = 120", "touches = 50", "expected a whole number from 100 to 2000"),
        ("poses = 10 ", "poses = 61 ", "found 61 with touches = 120"),
        ("base_mm = [280.0, 280.0]", "base_mm = [360.0, 280.0]", "a corner of it reaches"),
        ("base_mm = [280.0, 280.0]", "base_mm = [90.0, 280.0]", "160 mm or more"),
        ("table_radius_mm = 160.0", "table_radius_mm = 100.0", "a corner of it reaches"),
        (
            "table_radius_mm = 160.0",
            "table_radius_mm = 20.0",
            "160 mm or more: the smallest standard is 160 x 160 x 120 mm",
        ),
        ("max_mass_kg = 60.0", "max_mass_kg = 5.0", "more than 18.3 kg"),
        ("# slot_pitch_mm = 63.0", "slot_pitch_mm = 5.0", "found 5, expected 20 mm or more, or 0"),
        ("\nradius_mm = 3.0", "\nradius_mm = 20.0", "limits.min_concave_radius_mm"),
        ("gap_mm = 1.0", "gap_mm = -1.0", "limits.gap_mm"),
        ("B = [-90.0, 20.0]", "B = [28.0, 30.0]", "leave no room: they are approached"),
    ],
)
def test_bad_project(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, expected: str
) -> None:
    path = small_project(tmp_path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    assert main(["design", str(path), "-o", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err
    assert expected in message
    assert len([line for line in message.splitlines() if not line.startswith("[")]) == 1  # progress
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("relation", "shape"),
    [("groups", "stylus|body"), ("correlation", "model"), ("groups", "stack")],
)
def test_what_the_example_only_mentions_is_accepted(
    tmp_path: Path, relation: str, shape: str, unchanged: Unchanged
) -> None:
    """Every commented key, but of groups and correlations, and of probe shapes, one alone."""
    path = small_project(tmp_path)
    text = path.read_text().replace("draws = 300", "draws = 20480")
    other = {"groups": r"\[errors.correlation", "correlation": r"\[\[errors.groups"}[relation]
    text = re.sub(rf"(?m)^# {other}.*\n(# .*\n)*?(?=# \[|\n)", "", text)
    text = re.sub(rf"(?m)^# (?!{shape})(stylus|body|model|stack)\w* = .*\n", "", text)
    path.write_text(re.sub(r"(?m)^# (?=\[|\w+ = )", "", text))
    project = read_project(path)
    assert (project.study.digits, project.study.tolerance) == (1, pytest.approx(0.1))
    assert project.population.dependence is not None
    chain = project.chain
    assert project.population.mix_of(chain.symbol("EXX")).shapes == ("linear", "sinusoidal")
    assert project.population.ranges.of(chain, chain.symbol("EXC")) == (5.0 * UM, 10.0 * UM)
    named = ("probes", "options", "programs", "study", "task", "blank", "ball", "author", "riser")
    stated = {name: getattr(project, name) for name in named}
    unchanged(facts((stated, project.population.dependence, project.clampings)))


def test_blank_and_limits_reach_the_placement(tmp_path: Path) -> None:
    """The defaults are those of the example but for the table, which holds the default base: a
    corner is hypot(115, 115) + 25 = 187.6 mm from its middle. Other ones arrive in base units."""
    path = small_project(tmp_path)
    text = path.read_text()
    stated = read_project(path)
    path.write_text(re.sub(r"(?s)\[blank\].*?(?=\[setup\.a\])", "", text))
    left_out = read_project(path)
    assert left_out.blank.base == stated.blank.base
    assert stated.reach.table_radius == 160.0
    assert 187.6 < left_out.reach.table_radius == 190.0
    for key, value in {
        "base_mm": "[240.0, 200.0]",
        "height_mm": "180.0",
        "min_concave_radius_mm": "9.0",
        "max_slope_deg": "30.0",
        "gap_mm": "2.0",
        "max_mass_kg": "40.0",
        "table_radius_mm": "130.0",
    }.items():
        text = re.sub(rf"(?m)^{key} = [^#\n]*", f"{key} = {value} ", text)
    path.write_text(text)
    project = read_project(path)
    made = project.blank
    assert made.base.half_size == (120.0, 100.0)
    assert made.height == 180.0
    assert made.fittings.highest_sphere < 180.0
    assert made.limits == Limits(9.0, np.pi / 6.0, 3.0, 2.0, 40.0, 130.0)
    assert project.reach.table_radius == 130.0


def test_what_a_standard_is_chosen_for(tmp_path: Path) -> None:
    """The defaults are those of the example; every criterion and wish reaches the placement."""
    path = small_project(tmp_path)
    text = path.read_text()
    assert read_project(path).options == PlacementOptions(
        name="FFS-600U", serial="001", patches=3, balls=4, choice=TouchOptions(120, 10, 40)
    )
    plain = re.sub(
        r"(?m)^(criterion|potential|robust_machines|robust_share|poses = 10).*\n", "", text
    )
    assert "potential" not in re.sub("#.*", "", plain)
    path.write_text(plain)
    assert read_project(path).options.criterion == CriterionOptions("I", 0.3)
    for criterion in CRITERIA:
        wanted = text.replace('criterion = "I"', f'criterion = "{criterion}"')
        for key, value in (("robust_machines", "8"), ("robust_share", "0.5"), ("potential", "0.1")):
            wanted = re.sub(rf"(?m)^{key} = [\d.]+", f"{key} = {value}", wanted)
        path.write_text(wanted.replace("poses = 10 ", "poses = 12 "))
        options = read_project(path).options
        assert options.choice == TouchOptions(120, 12, 40)
        assert options.criterion == CriterionOptions(criterion, 0.1, 8, 0.5)
    assert read_project(path).remarks == ()


def test_keys_of_older_projects_are_read_and_named(tmp_path: Path) -> None:
    path = small_project(tmp_path)
    text = path.read_text().replace("robust_machines = 0", "drawn_machines = 8")
    path.write_text(text.replace("robust_share = 1.0", "worst_share = 0.5"))
    project = read_project(path)
    criterion = project.options.criterion
    assert (criterion.robust_machines, criterion.robust_share) == (8, 0.5)
    assert [remark.removeprefix(f"{path}: ") for remark in project.remarks] == [
        "standard.drawn_machines is now called standard.robust_machines and was read as such",
        "standard.worst_share is now called standard.robust_share and was read as such",
    ]


def test_the_material_of_a_project(tmp_path: Path) -> None:
    """Keys of older files are read; another material states its own density and expansion."""
    path = small_project(tmp_path)
    text = path.read_text()
    here = text.index("[material]"), text.index("[blank]")
    bare = text[: here[0]] + text[here[1] :]
    known = read_project(path).blank.material
    assert (known.modulus, known.poisson, known.modulus_source) == (200e3, 0.3, "stated")
    path.write_text(bare)
    usual = read_project(path).blank.material
    assert (usual.name, usual.density, usual.modulus) == (known.name, known.density, 200e3)
    assert "Uddeholm" in usual.modulus_source
    old = 'material = "EN AW-5083"\ndensity_kg_m3 = 2660.0\nexpansion_per_K = 23.8e-6\n'
    path.write_text(bare.replace("[standard]\n", f"[standard]\n{old}"))
    project = read_project(path)
    own = project.blank.material
    assert (own.name, own.density, own.expansion) == ("EN AW-5083", 2660 * 1e-9, 23.8e-6)
    assert own.modulus is None
    assert len(project.remarks) == 3
    path.write_text(bare.replace("[blank]", '[material]\nname = "EN AW-5083"\n\n[blank]'))
    with pytest.raises(BadFile, match=r"material\.density_kg_m3: found no value beside name = 'EN"):
        read_project(path)
    path.write_text(text.replace("modulus_MPa = 200000.0", "modulus_MPa = 200"))
    with pytest.raises(BadFile, match=r"material\.modulus_MPa"):
        read_project(path)


def test_amplitude_ranges_of_the_project(tmp_path: Path) -> None:
    path = small_project(tmp_path)
    ranges = "[errors.classes]\nsquareness = [1.0, 2.0]\n[errors.parameters]\nEXX = [3.0, 4.0]\n"
    path.write_text(path.read_text() + ranges)
    project = read_project(path)
    chain = project.chain
    assert project.population.ranges.of(chain, chain.symbol("EXX")) == (3.0 * UM, 4.0 * UM)
    assert project.population.ranges.of(chain, chain.symbol("EC0Y")) == (1.0 * URAD, 2.0 * URAD)
    assert project.population.ranges.of(chain, chain.symbol("EYX")) == (50.0 * UM, 100.0 * UM)


@rs274.is_there
def test_linuxcnc_takes_every_block_of_the_whole_programs(made: Path, tmp_path: Path) -> None:
    """The design is for an iTNC; its programs planned again from their text, for LinuxCNC."""
    chain, standard = read_machine(made / "machine.toml"), read_standard(made / "standard.toml")
    read = [read_program(path, chain) for path in sorted((made / "programs").glob("*.H"))]
    plan = shortened(read, standard, chain)
    programs = make_programs(plan, read_dialect("linuxcnc")).programs
    assert sum(p.touches for p in programs) == sum(len(p.touches) for p in read) > 100
    for program in programs:
        said = rs274.interpreted(rs274.all_met(program.text), tmp_path)
        assert "PROGRAM_END" in said
        assert said.count("STRAIGHT_PROBE") == 2 * program.touches


@pytest.mark.slow
def test_tenfold_for_every_seed_tried(tmp_path: Path) -> None:
    """The proof of the main job on ten random machines, probed by one design."""
    out = tmp_path / "out"
    project = small_project(tmp_path, machines=10, touches=240, poses=30)
    assert main(["design", str(project), "-o", str(out)]) == 0
    proof = json.loads((out / "identification.json").read_text())["volumetric_error"]
    assert len(proof) == 10
    assert len(list((out / "sensitivity").glob("*_3d.png"))) == 2
    assert min(machine["times_smaller"] for machine in proof) > 10.0
