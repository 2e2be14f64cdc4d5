"""What a page tells of cutters and stiffness: limits that are missed are named."""

from cad_out.making.cutting import Cutting
from cad_out.making.making_file import Making
from cad_out.making.stiffness import Stiffness
from report.pages.design_page import _making


def made(mode, sag, out_of_reach=()):
    cutting = Cutting(
        points={"FF": 10},
        upright=0.7,
        tilted=1.0 if not out_of_reach else 0.9,
        out_of_reach=out_of_reach,
        cutter={"FF1": 16.0},
        radius={"FF1": 12.0},
    )
    return dict(_making(Making(cutting, Stiffness(first_mode=mode, sag=sag, cube=10.0))))


def test_a_stiff_standard_that_a_cutter_reaches_is_told_by_its_figures():
    rows = made(900.4, {"FF1": 4e-5, "SPH1": 9e-5})
    assert rows["first mode on rigid screws"] == "900 Hz"
    assert rows["sag from upright to lying on its side"] == "SPH1 0.09 µm at most"
    assert next(iter(rows.values())).endswith("100 % tilted by 45° at most")
    assert "FF1 Ø16" in rows.values()


def test_what_is_beyond_a_limit_is_named():
    rows = made(400.0, {"FF1": 4e-5, "SPH2": 5e-4, "SPH1": 2e-4}, ("FF1 wall",))
    assert rows["first mode on rigid screws"] == "400 Hz; at least 500 Hz are wanted"
    sag = rows["sag from upright to lying on its side"]
    assert sag == "SPH2 0.50 µm at most; beyond 0.1 µm: SPH1, SPH2"
    assert next(iter(rows.values())).endswith("not at all: FF1 wall")
