"""Directions of approach as tables state them, and figures of ISO 230-2 made of them by hand."""

import numpy as np
import pytest

from matstd.importers import read_positioning, read_sheet
from matstd.importers.instruments import positioning_figures
from matstd.importers.sheets import approaches
from matstd.twin.errors import BadFile
from matstd.twin.units import UM

PARTS = """# test of X

Data forward direction

i |target [mm]|ref_pos(i,1) [mm]|ref_pos(i,2) [mm]|
--- |--- |--- |--- |
1|0.0|0.001|0.003|
2|10.0|10.004|10.006|

Data backward direction

i |target [mm]|ref_pos(i,1) [mm]|ref_pos(i,2) [mm]|
--- |--- |--- |--- |
1|0.0|-0.004|-0.002|
2|10.0|10.001|10.003|
"""


REPORT = f"""# Gear Ratios
From | To | Ratio []| Count []
--- |--- |--- |--- |
1 | 2 | 0.5 | 50

{PARTS}
## Deviations computed from them

i |x(i,1) [mm]|x(i,2) [mm]|x_avg(i) [mm]|
--- |--- |--- |--- |
1|0.1|0.2|0.3|
2|0.4|0.5|0.6|
"""


def positioning(tmp_path, text):
    path = tmp_path / "table.csv"
    path.write_text(text, encoding="utf-8")
    return read_positioning(read_sheet(path), "X")


@pytest.mark.parametrize(
    ("up", "down"),
    [("up", "down"), ("fwd", "bwd"), ("vor", "zurück"), ("+", "-"), ("pos", "neg"), ("↑", "↓")],
)
def test_words_of_directions(tmp_path, up, down):
    text = f"target [mm];1 {up} [µm];1 {down} [µm]\n0;1;2\n10;3;4\n"
    test = positioning(tmp_path, text)
    assert test.deviation[test.direction > 0] / UM == pytest.approx([1.0, 3.0])
    assert test.deviation[test.direction < 0] / UM == pytest.approx([2.0, 4.0])


def test_of_a_report_with_several_tables_the_fullest_is_read(tmp_path):
    """Its readings stand in two parts with one header; what is computed of them is below."""
    alone, among = positioning(tmp_path, PARTS), positioning(tmp_path, REPORT)
    np.testing.assert_array_equal(among.deviation, alone.deviation)
    np.testing.assert_array_equal(among.direction, alone.direction)
    sheet = read_sheet(tmp_path / "table.csv")
    assert sheet.left_out[:2] == (2, 4)
    assert len(sheet) == 4


def test_a_word_that_states_no_direction_beside_others_is_refused(tmp_path):
    text = "target [mm];1 up [µm];1 xyz [µm]\n0;1;2\n10;3;4\n"
    with pytest.raises(BadFile, match=r"column '1 xyz \[µm\]', expected up or down"):
        positioning(tmp_path, text)


def test_a_table_in_two_parts_says_which_is_which(tmp_path):
    test = positioning(tmp_path, PARTS)
    for sign, expected in ((1, [1.0, 4.0, 3.0, 6.0]), (-1, [-4.0, 1.0, -2.0, 3.0])):
        own = test.direction == sign
        assert test.deviation[own] / UM == pytest.approx(expected)
        assert test.cycle[own].tolist() == [1, 1, 2, 2]


@pytest.mark.parametrize(
    ("targets", "signs", "cycles"),
    [
        ([0, 1, 2, 3, 3, 2, 1, 0, 0, 1], [1, 1, 1, 1, -1, -1, -1, -1, 1, 1], [1] * 8 + [2, 2]),
        ([0, 1, 2, 3, 2, 1, 0, 1], [1, 1, 1, 1, -1, -1, -1, 1], [1] * 7 + [2]),
        ([0, 1, 2, 3, 4, 0, 1, 2, 3, 4], [1] * 10, [1] * 5 + [2] * 5),
        ([0, 0, 0, 1, 1, 1, 2, 2, 2], [0] * 9, [1] * 9),
    ],
    ids=["turn twice", "turn once", "one way", "sorted"],
)
def test_the_order_of_rows_gives_directions(targets, signs, cycles):
    sign, cycle = approaches(np.array(targets, dtype=float))
    assert sign.tolist() == signs
    assert cycle.tolist() == cycles


def test_figures_of_the_standard_by_hand(tmp_path):
    """Means 2, 5 up and -3, 2 down, every estimator sqrt(2) µm."""
    found = positioning_figures(positioning(tmp_path, PARTS))
    s = np.sqrt(2.0)
    assert found.reversal / UM == pytest.approx(5.0)
    assert found.mean_reversal / UM == pytest.approx(4.0)
    assert found.mean_range / UM == pytest.approx(4.0)
    assert found.systematic / UM == pytest.approx(8.0)
    assert found.repeatability / UM == pytest.approx(4.0 * s + 5.0)
    assert found.accuracy / UM == pytest.approx(8.0 + 4.0 * s)


def test_import_reports_the_figures_and_what_is_missing(tmp_path, answer):
    path = tmp_path / "parts.md"
    path.write_text(PARTS, encoding="utf-8")
    arguments = ["--positioning", "X", "--u-um", "1", "-o", str(tmp_path / "a.csv")]
    message = answer(["import", str(path), *arguments])
    assert "ISO 230-2: reversal B 5 µm (mean 4), M 4, E 8, R 10.7, A 13.7 µm" in message
    path.write_text("target [mm],1 [µm],2 [µm]\n0,1,2\n10,3,4\n", encoding="utf-8")
    assert "no direction of approach is stated" in answer(
        ["import", str(path), *arguments, "--force"]
    )


@pytest.mark.parametrize(
    "text",
    [
        # French, with a blank row and a mean below; a column a target; names above names, units
        "Axe;X\n\nCible [mm];1 aller [µm];1 retour [µm]\n0,0;1,0;-1,0\n\n50,0;2,0;0,5\nMoyenne;;\n",
        "Axis X\nTarget [mm],0,50\n1 fwd [um],1.0,2.0\n1 rev [um],-1.0,0.5\n",
        ",Cycle 1,\nTarget,up,down\nmm,um,um\n0,1.0,-1.0\n50,2.0,0.5\n",
    ],
)
def test_layouts_of_other_countries_and_programs(tmp_path, text):
    (tmp_path / "t.csv").write_text(text, encoding="utf-8")
    test = read_positioning(read_sheet(tmp_path / "t.csv"), "X")
    order = np.lexsort([test.target, -test.direction])
    np.testing.assert_allclose(test.deviation[order] / UM, [1.0, 2.0, -1.0, 0.5])
    assert test.target[order].tolist() == [0.0, 50.0, 0.0, 50.0]
