"""Words of a program by hand: preset at the table's origin, Z of the ball's far pole."""

import numpy as np
import pytest

from matstd.artefact.tool import Probe
from matstd.probe_paths.plan import ProgramFrame
from matstd.twin.units import DEG

ROUNDING = 1e-12


@pytest.fixture(scope="module")
def frame(chain):
    """Table origin at Z -500; ball of 3 mm at 160 mm, so the tool table has 163 mm."""
    return ProgramFrame(chain, Probe(3.0, 160.0))


def test_words_of_readings_by_hand(frame):
    assert frame.coordinate("X", 12.5) == 12.5
    assert frame.coordinate("Z", -200.0) == pytest.approx(-200.0 + 500.0 - 163.0, abs=ROUNDING)
    assert frame.coordinate("B", -30.0 * DEG) == pytest.approx(-30.0, abs=ROUNDING)


def test_reading_and_word_are_each_others_inverse(frame):
    for letter in frame.letters:
        assert frame.coordinate(letter, frame.reading(letter, 17.25)) == pytest.approx(17.25)


def test_letters_and_columns_agree_with_the_chain(frame, chain):
    assert frame.letters == ("X", "Y", "Z", *chain.rotary_axes)
    q = np.arange(len(chain.axes), dtype=float)
    words = frame.coordinates(q, "XY")
    assert words == {a: q[chain.axis_index(a)] for a in "XY"}
    assert [chain.axes[i] for i in frame.linear] == ["X", "Y", "Z"]
    assert [chain.axes[i] for i in frame.rotary] == list(chain.rotary_axes)
