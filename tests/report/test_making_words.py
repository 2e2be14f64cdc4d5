"""Compromises of a design are named on the console, with the key that changes them."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.artefact.brief import Brief
from matstd.artefact.layout import Blank
from matstd.artefact.price import Construction, prices_of
from matstd.cad_out.making import Making, Stiffness
from matstd.report.task import fewer_lines, making_lines, price_lines
from matstd.stages.design import _check_first_mode
from matstd.twin.errors import BadFile


def stiffness(first_mode: float) -> Stiffness:
    return Stiffness(first_mode, {"SPH1": np.eye(3)}, {"SPH1": 9e3, "SPH2": 2.5e3}, 10.0)


def test_a_low_first_mode_is_a_named_compromise(upright) -> None:
    made = Making(None, stiffness(412.3), {}, upright.material)
    _, price, words = making_lines(made)
    assert price == "price: not estimated, no rates are known of this material"
    assert words.startswith("compromise: first mode 412 Hz on rigid screws, below 500 Hz")
    assert "softest ball SPH2, 2.5 N/µm" in words
    assert len(making_lines(replace(made, stiffness=stiffness(500.0)))) == 2


def test_the_cheaper_construction_is_named_where_it_is_clear(upright) -> None:
    billet, parts = prices_of(upright)
    (line,) = price_lines((billet, parts), Construction.PARTS)
    assert "all in one from a billet" in line
    assert "kg of stock" in line
    apart = replace(billet, labour=billet.labour * 2.0)
    (clear,) = price_lines((apart, parts), Construction.PARTS)
    assert "; plate, studs and a block for every face is" in clear
    assert clear.endswith("make standard-parts.step, plate, studs and a block for every face")
    (same,) = price_lines((parts, parts), Construction.BILLET)
    assert "they differ by less than the uncertainty of one: make standard.step, all in" in same


def test_a_limit_refuses_it() -> None:
    blank = Blank()
    brief = Brief(chain=None, blank=blank, first_mode=450.0)
    _check_first_mode(brief, stiffness(450.0))
    _check_first_mode(replace(brief, first_mode=0.0), stiffness(10.0))
    with pytest.raises(BadFile, match="first_mode_Hz: found 450, expected at most 449"):
        _check_first_mode(brief, stiffness(449.2))
    with pytest.raises(BadFile, match="whose modulus is not known"):
        _check_first_mode(brief, None)


def test_fewer_balls_are_named_with_what_binds(upright) -> None:
    count = len(upright.spheres)
    assert fewer_lines(upright, count, 20.0, 60.0) == []
    (room,) = fewer_lines(upright, 13, 20.0, 60.0)
    assert room.startswith(f"compromise: {count} balls of standard.balls = 13: beside")
    assert "blank.base_mm" in room
    (heavy,) = fewer_lines(upright, 13, 59.0, 60.0)
    assert "limits.max_mass_kg = 60 (59.0 kg now)" in heavy
