"""Letters of dots: distinct, spotted into plane faces, exact."""

import numpy as np
import pytest

from matstd.cad_out.details import CUTTER, DEPTH, DOT, Lettering
from matstd.cad_out.details.dot_font import _GLYPHS, LARGE, SMALL, dots, size
from matstd.twin.frames import pose

CAP = np.pi * DEPTH**2 * (3.0 * CUTTER - DEPTH) / 3.0
"""Textbook volume of what the cutter takes away at a dot, mm^3."""


@pytest.mark.parametrize("rows", [SMALL, LARGE])
def test_every_letter_is_another_and_stays_in_its_box(rows):
    shapes = {letter: dots(letter, rows).tobytes() for letter in _GLYPHS}
    assert len(set(shapes.values())) == len(_GLYPHS)
    for letter in set(_GLYPHS) - {" "}:
        at = dots(letter, rows)
        assert at.min() >= DOT - 1e-12
        assert (at <= size(letter, rows) - DOT + 1e-12).all()
    ink = dots("FF12", rows)
    apart = np.linalg.norm(ink[:, None] - ink, axis=2)[~np.eye(len(ink), dtype=bool)]
    assert apart.min() > 2.0 * DOT  # dots stay apart: no edge is cut


def test_an_f_points_up_and_to_the_right():
    at = dots("F", LARGE)
    assert at[:, 1].mean() > 0.5 * size("F", LARGE)[1]
    assert at[:, 0].mean() < 0.5 * size("F", LARGE)[0]


def engraved_cube(*lines):
    """A cube of 20 mm; the kernel, which takes two seconds to load, is loaded here."""
    from matstd.cad_out.kernel.letters import engraved
    from matstd.cad_out.kernel.primitives import box

    return engraved(box((0.0, 0.0, 0.0), (20.0, 20.0, 20.0)), lines)


@pytest.mark.parametrize("rows", [SMALL, LARGE])
@pytest.mark.parametrize("turn", [np.eye(3), [[0, 0, 1], [1, 0, 0], [0, 1, 0]]], ids=["top", "+x"])
def test_dots_take_their_caps_away(turn, rows):
    from matstd.cad_out.kernel.faces import area, faces_of, is_closed, is_valid, volume

    R = np.array(turn, dtype=float)
    line = Lettering("A7", pose(R, R @ [1.0, 1.0, 20.0]), rows)
    made = engraved_cube(line)
    assert is_valid(made)
    assert is_closed(made)
    assert 8000.0 - volume(made) == pytest.approx(len(line.dots) * CAP, rel=1e-6)
    assert min(area(f) for f in faces_of(made)) == pytest.approx(2.0 * np.pi * CUTTER * DEPTH)


def test_a_line_that_leaves_its_face_is_cut_all_the_same():
    from matstd.cad_out.kernel.faces import is_closed, is_valid, volume

    beyond = Lettering("A7", pose(t=np.array([16.2, 5.0, 20.0])), LARGE)
    inside = Lettering("A", pose(t=np.array([5.0, 5.0, 20.0])), LARGE)
    made = engraved_cube(beyond, inside)
    assert is_valid(made)
    assert is_closed(made)
    taken, all_of_it = 8000.0 - volume(made), (len(beyond.dots) + len(inside.dots)) * CAP
    assert len(inside.dots) * CAP < taken < all_of_it
