"""What a page says of cutters and stiffness: limits that are missed are named."""

import numpy as np

from matstd.artefact.body import Material
from matstd.cad_out.making import Cutting, FaceHint, Making, Stiffness
from matstd.report.pages.standard_sections import making_rows
from matstd.twin.units import DEG


def made(mode, sag, out_of_reach=()):
    cutting = Cutting(
        points={"FF": 10},
        upright=0.7,
        tilted=1.0 if not out_of_reach else 0.9,
        out_of_reach=out_of_reach,
        overhang=80.0 if out_of_reach else 60.0,
        cutter={"FF1": 16.0},
        radius={"FF1": 12.0},
        whole_radius={"FF1": 11.0},
    )
    soft = {name: np.diag([size, size, 0.0]) for name, size in sag.items()}
    hints = {
        "FF1": FaceHint(
            convex=30.0,
            slope=(5.0 * DEG, 31.0 * DEG),
            step_over=(0.13, 0.18, 0.26),
            tilts=(0.0, 15.0 * DEG),
            axis=(15.0 * DEG, 90.0 * DEG) if not out_of_reach else None,
            contact=(12.0 * DEG, 44.0 * DEG) if not out_of_reach else None,
        )
    }
    return dict(
        making_rows(
            Making(
                cutting,
                Stiffness(mode, soft, {"SPH1": 9e3, "SPH2": 8.4e3}, cube=10.0) if mode else None,
                hints,
                Material("EN AW-5083", 2.66e-6, 23.8e-6, modulus=71e3 if mode else None),
            )
        )
    )


def test_a_stiff_standard_that_a_cutter_reaches_is_reported_by_its_figures():
    rows = made(900.4, {"FF1": 4e-5, "SPH1": 9e-5})
    assert rows["first mode on rigid screws"] == "900 Hz"
    assert rows["Young's modulus"] == "71 GPa, Poisson's ratio 0.3 of 'EN AW-5083' (stated)"
    assert rows["sag from upright to lying on its side"] == (
        "SPH1 0.09 µm at most; corrected by evaluations ([sag] of standard.toml)"
    )
    assert rows["softest ball, in its softest direction"] == (
        "SPH2 8.4 N/µm on its post, plate and pads"
    )
    assert rows["milling FF1 with 6 mm"] == (
        "slopes 5 to 31°; step-over 0.13 mm for Ra 0.2 µm, 0.18 mm for Ra 0.4 µm, 0.26 mm for "
        "Ra 0.8 µm; reached at tilts of 0, 15°; farthest from the tip at 15° towards 90° (contact "
        "at 12 to 44°)"
    )
    assert next(iter(rows.values())).endswith("100 % tilted by 45° at most")
    assert "FF1 Ø16" in rows.values()


def test_what_is_beyond_a_limit_is_named():
    rows = made(400.0, {"FF1": 4e-5, "SPH2": 5e-4, "SPH1": 2e-4}, ("FF1 wall",))
    assert rows["first mode on rigid screws"] == "400 Hz; required: 500 Hz or more"
    sag = rows["sag from upright to lying on its side"]
    assert sag.startswith("SPH2 0.50 µm at most; more than 0.1 µm: SPH1, SPH2; corrected")
    assert rows["milling FF1 with 6 mm"].endswith(
        "no single tilt of the axis up to 45° reaches all of it"
    )
    assert next(iter(rows.values())).endswith(
        "90 % tilted by 45° at most, not at all: FF1 wall; with an overhang of 80 mm it reaches "
        "all of them"
    )


def test_without_a_modulus_nothing_is_said_of_stiffness():
    rows = made(None, {"FF1": 4e-5})
    assert rows["first mode, stiffness and sag"].startswith(
        "unknown: no modulus is stated for 'EN AW-5083'; state material.modulus_MPa"
    )
    assert not {"Young's modulus", "first mode on rigid screws"} & set(rows)
