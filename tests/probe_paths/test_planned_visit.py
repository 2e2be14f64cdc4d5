"""Programs of a planned visit: its order, its sides, its standstill; all touches on the twin."""

import numpy as np
import pytest
from unchanged import folded, page_text

from matstd.api.replanning import planned_visit
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.language.text import MAX_NAME
from matstd.probe_paths.locate.planned_visit import VisitSchedule, read_visit
from matstd.twin.errors import BadFile
from matstd.twin.units import DEG

HEAD = "# warm_up_s = 1800, pause_s = 3600 after touch 6, slowness = 2\n"

SIDES = ((1, -1), (-1, -1), (1, 1), (-1, 1))


@pytest.fixture
def visit(plan, chain, tmp_path):
    """Three touches at four poses, one of them twice, each from stated sides."""
    axes = chain.rotary_axes
    head = ["feature", "setup", *(f"p{c}_mm" for c in "xyz"), *(f"{a}_deg" for a in axes)]
    lines = [HEAD + ",".join([*head, *(f"dir{a}" for a in axes)])]
    for k, sides in zip((2, 0, 3, 0), SIDES, strict=True):
        for i in np.flatnonzero((plan.visit == k) & (plan.request >= 0))[:3]:
            numbers = [*plan.point[i], *(plan.visits[k].rotary / DEG)]
            place = [f"{v:.6f}" for v in numbers]
            lines.append(",".join([plan.feature[i], plan.setup.name, *place, *map(str, sides)]))
    path = tmp_path / "next_visit.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_the_programs_of_a_visit_keep_its_order_sides_and_standstill(
    design, visit, plan, unchanged
) -> None:
    made = planned_visit(visit, design)
    (station,) = made.stations
    found = station.plan
    assert [tuple(v.side.astype(int)) for v in found.visits] == list(SIDES)
    wanted = [plan.visits[k].rotary for k in (2, 0, 3, 0)]
    np.testing.assert_allclose([v.rotary for v in found.visits], wanted, atol=1e-9)
    for k, rows in enumerate(found.request[found.request >= 0].reshape(4, 3)):
        assert sorted(rows) == [3 * k, 3 * k + 1, 3 * k + 2]
    first, second = station.programs.programs
    assert [first.touches, second.touches] == [8, 8]  # an anchor at every visit
    assert made.lines[0].startswith("The twin made all 16 touches")
    assert f"before {second.name}" in " ".join(made.lines)
    assert "feed override 50 %" in " ".join(made.lines)
    unchanged("\n".join([folded(first.text), folded(second.text), *made.lines]))


def test_the_command_writes_the_visit(
    design, visit, tmp_path, monkeypatch, answer, unrendered, unchanged
) -> None:
    out = tmp_path / "out"
    monkeypatch.setenv("COLUMNS", "100")
    said = answer(["replan", str(visit), "--design", str(design), "-o", str(out)])
    said = said.replace(str(tmp_path), "").replace(str(design), "")
    files = sorted(p.relative_to(out).as_posix() for p in out.rglob("*"))
    page = page_text((out / "setup" / "setup.html").read_text(encoding="utf-8"))
    unchanged("\n".join([said, *files, page, ""]))


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("FF1", "FF9", r"line \d, feature"),
        (",a,", ",elsewhere,", "setup"),
        ("pz_mm", "pw_mm", "pz_mm"),
    ],
)
def test_a_visit_of_something_else_is_refused(design, visit, old, new, line) -> None:
    visit.write_text(visit.read_text().replace(old, new), encoding="utf-8")
    with pytest.raises(BadFile, match=line):
        planned_visit(visit, design)


def test_touches_of_ones_own_without_a_first_line_are_made_at_the_usual_pace(
    visit, plan, chain
) -> None:
    visit.write_text(visit.read_text().removeprefix(HEAD), encoding="utf-8")
    _, schedule = read_visit(visit, chain, plan.standard)
    assert schedule == VisitSchedule(warm_up=0.0, pause=0.0, slowness=1.0)


def test_touches_beside_the_standard_are_refused(design, visit) -> None:
    lines = visit.read_text().splitlines()
    cells = lines[2].split(",")
    cells[2] = f"{float(cells[2]) + 1.0:.6f}"
    cells[4] = f"{float(cells[4]) + 5.0:.6f}"
    lines[2] = ",".join(cells)
    visit.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(BadFile, match=r"line 3, px_mm to pz_mm.* of this standard"):
        planned_visit(visit, design)


def test_the_programs_of_a_visit_replace_none_of_the_run() -> None:
    """`MS_CORNER_33_LOC` has the 16 letters of the oldest software."""
    words = [Dialect()]
    for _ in range(3):
        words.append(words[-1].of_visit("A_LOC"))
    assert [one.prefix for one in words] == ["MS", "MSV", "MSV2", "MSV3"]
    assert Dialect(prefix="MS30").of_visit("A_LOC").prefix == "MS30V"
    long = Dialect().of_visit("CORNER_33_LOC")
    assert (long.prefix, long.of_visit("CORNER_33_LOC").prefix) == ("MV", "V2")
    assert len(f"{long.prefix}_CORNER_33_LOC") == MAX_NAME
