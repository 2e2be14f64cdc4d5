"""The size of a standard in a run file: taken off once, given back on writing, refused by name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from run_text import COLUMNS, HEAD, ROW, later, write

from matstd.twin.effects import setup_errors
from matstd.twin.effects.artefact import ArtefactExpansion
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run, write_run
from matstd.twin.model import columns
from matstd.twin.record import computed_deviation, joined
from matstd.twin.units import NM, UM

STEEL = "expansion_1_K = 10.5e-6"
BODY_COLUMN = COLUMNS.replace("T_s_degC", "T_body_degC")


def head(stated: str) -> str:
    return HEAD.replace("# [setup.a]", f"# standard = {{ {stated} }}\n# [setup.a]")


def read(folder: Path, stated: str, *rows: str, columns: str = COLUMNS):
    return read_run(write(folder, list(rows or (ROW,)), head=head(stated), columns=columns))


def test_growth_by_hand(tmp_path: Path) -> None:
    """A face at z = 36.998 of a standard 5 K warm stands 10.5e-6 * 5 * 36.998 mm = 1.942 um higher.

    So the 2 um by which it is believed to stand too high are 0.058 um of an error.
    """
    grown = 10.5e-6 * 5.0 * 36.998
    run = read(tmp_path, f"{STEEL}, body_degC = 25.0")
    assert run.deviation == pytest.approx([2.0 * UM - grown], abs=0.001 * NM)
    assert run.raw_deviation == pytest.approx([2.0 * UM], abs=0.001 * NM)
    stated = read(
        tmp_path, f"{STEEL}, body_degC = 25.0", ROW + ",7.25", columns=COLUMNS + ",dev_um"
    )
    assert stated.deviation == pytest.approx([7.25 * UM - grown], abs=0.001 * NM)
    cold = read(tmp_path, f"{STEEL}, body_degC = 15.0")
    assert cold.deviation == pytest.approx([2.0 * UM + grown], abs=0.001 * NM)


def test_defaults_and_what_is_free_in_a_fit(tmp_path: Path) -> None:
    """Ten percent of the expansion; 0.3 K of a stated temperature, 2 K about 20 degC of another."""
    known, unknown = read(tmp_path, f"{STEEL}, body_degC = 25.0"), read(tmp_path, STEEL)
    for run, u_temperature, expected in (
        (known, 0.3, {"body-temperature": 0.3, "body-expansion(1.05e-05)": 1.05e-6}),
        (unknown, 2.0, {"body-temperature": 2.0}),
    ):
        body = run.touches.setups[0].body
        assert (body.u_alpha, body.u_temperature) == pytest.approx((1.05e-6, u_temperature))
        sizes = [e for e in setup_errors(run.touches) if e.kind.startswith("body")]
        assert {e.name: e.parameters[0].sd for e in sizes} == pytest.approx(expected)
        # a kelvin, and 1e-6 1/K at 5 K, of the face at z = 36.998
        by_hand = [10.5e-6 * 36.998, 5.0 * 36.998][: len(sizes)]
        assert columns(sizes, run.touches)[0] == pytest.approx(by_hand)
    assert unknown.deviation == pytest.approx([2.0 * UM], abs=0.001 * NM)
    own = read(tmp_path, f"{STEEL}, expansion_u_1_K = 2e-7, body_u_K = 0.5").touches.setups[0].body
    assert (own.u_alpha, own.u_temperature, own.is_known) == (2e-7, 0.5, False)


def test_a_run_that_states_nothing_is_read_as_before(tmp_path: Path) -> None:
    row = ROW.replace("20.5", "25.0")
    run = read_run(write(tmp_path, [row], columns=BODY_COLUMN))
    assert run.deviation == pytest.approx([2.0 * UM], abs=0.001 * NM)
    assert [e.kind for e in setup_errors(run.touches)] == ["setup"]
    assert run.remarks == ()  # not "cannot explain anything": 5 K are 2 um here
    assert run.touches.temperature["body"].tolist() == [25.0]


def test_a_sensor_on_the_standard_counts_touch_by_touch(tmp_path: Path) -> None:
    rows = [ROW.replace("20.5", "22.0"), later(ROW, 9.0).replace("20.5", "25.0")]
    run = read(tmp_path, STEEL, *rows, columns=BODY_COLUMN)
    grown = 10.5e-6 * np.array([2.0, 5.0]) * 36.998
    assert run.deviation == pytest.approx(2.0 * UM - grown, abs=0.001 * NM)
    # what is taken off is no effect of that sensor any more, and all of it is one of another
    assert not columns([ArtefactExpansion("body")], run.touches).any()
    plain = read_run(write(tmp_path, rows, columns=BODY_COLUMN))
    stated = columns([ArtefactExpansion("body")], plain.touches)[:, 0]
    assert 10.5e-6 * stated == pytest.approx(
        grown, rel=1e-3
    )  # here p counts from the table's origin


@pytest.mark.parametrize("column", [False, True])
@pytest.mark.parametrize("temperature", ["", ", body_degC = 25.0, body_u_K = 2.5"])
def test_the_file_keeps_the_raw_record(tmp_path: Path, temperature: str, column: bool) -> None:
    rows = [ROW.replace("20.5", "24.0"), later(ROW, 9.0).replace("20.5", "25.0")]
    run = read(tmp_path, STEEL + temperature, *rows, columns=BODY_COLUMN if column else COLUMNS)
    write_run(tmp_path / "again.csv", run, "machine.toml")
    written = (tmp_path / "again.csv").read_text()
    assert [line.rpartition(",")[2] for line in written.splitlines()[-2:]] == ["2.000000"] * 2
    again = read_run(tmp_path / "again.csv")
    assert again.deviation == pytest.approx(run.deviation, abs=0.001 * NM)
    assert again.touches.setups[0].body == run.touches.setups[0].body
    assert computed_deviation(again.touches) == pytest.approx(run.deviation, abs=0.1 * NM)
    # one measurement, whatever is stated of its temperature
    assert again.fingerprint == run.fingerprint
    assert read_run(write(tmp_path, rows)).fingerprint == run.fingerprint


def test_joined_runs_keep_their_temperatures_and_share_the_expansion(tmp_path: Path) -> None:
    rows = [ROW.replace("20.5", "24.0"), later(ROW, 9.0).replace("20.5", "25.0")]
    one = read(tmp_path, STEEL, *rows, columns=BODY_COLUMN)
    other = read(tmp_path, f"{STEEL}, body_degC = 18.0", later(ROW, 3.0))
    nothing = read_run(write(tmp_path, [ROW.replace("-300.0", "-300.001")]))
    both = joined({"spring": one, "autumn": other, "before": nothing})
    assert both.touches.body_temperature.tolist() == [24.0, 25.0, 18.0, 20.0]
    assert both.deviation == pytest.approx([*one.deviation, *other.deviation, *nothing.deviation])
    sizes = {e.name: e for e in setup_errors(both.touches) if e.kind.startswith("body")}
    assert list(sizes) == [
        "body-temperature(spring)",
        "body-temperature(autumn)",
        "body-expansion(1.05e-05)",
    ]
    here = [e.here(both.touches).tolist() for e in sizes.values()]
    assert here == [[1, 1, 0, 0], [0, 0, 1, 0], [1, 1, 1, 0]]


def test_the_scale_of_the_cmm_is_one_error_of_all_runs_of_a_standard(tmp_path: Path) -> None:
    """Per unit it moves every calibrated point from the origin by its own coordinates."""
    stated = f"{STEEL}, body_degC = 20.0, scale_u_ppm = 5.25"
    run = read(tmp_path, stated)
    one, *others = [e for e in setup_errors(run.touches) if e.kind == "body-scale"]
    assert not others
    assert [p.sd for p in one.parameters] == pytest.approx([5.25e-6])
    along = np.einsum("ni,ni->n", run.touches.point, run.touches.normal)
    assert columns([one], run.touches)[:, 0] == pytest.approx(along)
    write_run(tmp_path / "again.csv", run, "machine.toml")
    again = read_run(tmp_path / "again.csv").touches
    assert again.setups[0].body == run.touches.setups[0].body
    both = joined({"spring": run, "autumn": read(tmp_path, stated, ROW, later(ROW, 3.0))}).touches
    scale = [e for e in setup_errors(both) if e.kind == "body-scale"]
    assert len(scale) == 1
    assert columns(scale, both)[:, 0].all()


@pytest.mark.parametrize(
    ("stated", "expected"),
    [
        (f"{STEEL}, scale_u_ppm = 5e3", "standard.scale_u_ppm: found 5000, expected the standard"),
        ("expansion_1_K = 11.5", "standard.expansion_1_K: found 11.5, expected 0 to 0.001 1/K"),
        ("expansion_1_K = -1e-6", "standard.expansion_1_K: found -1e-06"),
        (f"{STEEL}, expansion_u_1_K = 1.0", "standard.expansion_u_1_K: found 1,"),
        (f"{STEEL}, body_degC = 295.0", r"standard.body_degC: found 295 \(in kelvin\?\)"),
        (f"{STEEL}, body_degC = 80.0", r"standard.body_degC: found 80 \(of another body\?\)"),
        (f"{STEEL}, body_degC = 25.0, body_u_K = -0.5", "standard.body_u_K: found -0.5"),
        ("body_degC = 25.0", "standard.expansion_1_K: found nothing, expected a number in 1/K"),
        (f"{STEEL}, body_C = 25.0", "standard.body_C: found an unknown key"),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(tmp_path: Path, stated: str, expected: str) -> None:
    with pytest.raises(BadFile, match=expected):
        read(tmp_path, stated)


@pytest.mark.parametrize(
    ("reading", "stated", "expected"),
    [
        (
            "25.0",
            ", body_degC = 21.0",
            "body_degC: found 21, where T_body_degC is 25.00 on average",
        ),
        ("61.0", "", r"T_body_degC: found 61 \(of another body\?\), expected the temp"),
        ("295.0", "", r"line 10, column T_body_degC: found 295, expected .* \(not kelvin\)"),
    ],
)
def test_a_sensor_that_is_not_on_the_standard(
    tmp_path: Path, reading: str, stated: str, expected: str
) -> None:
    with pytest.raises(BadFile, match=expected):
        read(tmp_path, STEEL + stated, ROW.replace("20.5", reading), columns=BODY_COLUMN)


def test_a_sensor_and_a_head_that_agree(tmp_path: Path) -> None:
    run = read(
        tmp_path,
        f"{STEEL}, body_degC = 25.3, body_u_K = 0.2",
        ROW.replace("20.5", "25.0"),
        columns=BODY_COLUMN,
    )
    assert run.touches.body_temperature.tolist() == [25.0]


def test_only_a_probe_touches_a_standard(tmp_path: Path) -> None:
    text = head(STEEL).replace("# [setup.a]", '# instrument = "laser"\n# [setup.a]')
    with pytest.raises(BadFile, match="expansion of a standard in a run of a laser"):
        read_run(write(tmp_path, [ROW + ",1.0"], head=text, columns=COLUMNS + ",dev_um"))


def test_rows_that_are_picked_keep_their_temperature(tmp_path: Path) -> None:
    rows = [ROW.replace("20.5", "24.0"), later(ROW, 9.0).replace("20.5", "25.0")]
    run = read(tmp_path, STEEL, *rows, columns=BODY_COLUMN)
    assert run[[1]].touches.body_temperature.tolist() == [25.0]
    assert replace(run[[1]]).raw_deviation == pytest.approx([2.0 * UM], abs=0.001 * NM)
