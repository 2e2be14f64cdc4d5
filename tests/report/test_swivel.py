"""The remark on an axis inclined by design, with the looks of table and tool worked by hand."""

import pytest

from matstd.report.machine import swivel_remarks
from matstd.twin.machine import Axis, make_chain

TRAVELS = dict.fromkeys("XYZ", Axis(range=(-300.0, 300.0)))


def chain_with(notation, direction, turn=(-1.0, 3.2)):
    axes = TRAVELS | {"B": Axis(range=turn, direction=direction), "C": Axis(range=(-6.0, 6.0))}
    return make_chain("swivel", notation, {k: v for k, v in axes.items() if k in notation})


@pytest.mark.parametrize(
    ("notation", "direction", "words"),
    [
        # z turned by a quarter about b = (0, 1, 1): (z . b) b = (0, 1, 1) / 2, b x z = (1, 0, 0)
        # the body of a table turns by minus the reading
        (
            "[w C' B' f X Y Z t]",
            (0.0, 1.0, 1.0),
            "the face of the table looks towards [-0.707, 0.5,",
        ),
        (
            "[w C' B' f X Y Z t]",
            (0.0, -1.0, -1.0),
            "the face of the table looks towards [0.707, 0.5,",
        ),
        ("[w f X Y Z C B t]", (0.0, 1.0, 1.0), "the tool points towards [-0.707, -0.5, -0.5]"),
    ],
)
def test_where_a_swivel_looks(notation, direction, words):
    (remark,) = swivel_remarks(chain_with(notation, direction))
    assert f"At B = 90° {words}" in remark
    (mirrored,) = swivel_remarks(chain_with(notation, tuple(-v for v in direction)))
    looks = [text.split("towards ")[1].split("]")[0] for text in (remark, mirrored)]
    assert f"if it looks towards {looks[1]}" in remark
    assert f"if it looks towards {looks[0]}" in mirrored


@pytest.mark.parametrize("direction", [None, (0.0, -1.0, 0.0), (0.01, 1.0, 0.0)])
def test_nothing_is_asked_of_an_axis_along_its_letter(direction):
    assert swivel_remarks(chain_with("[w C' B' f X Y Z t]", direction)) == []


def test_a_short_travel_is_looked_at_at_its_end():
    (remark,) = swivel_remarks(chain_with("[w C' B' f X Y Z t]", (0.0, 1.0, 1.0), (-0.5, 0.2)))
    assert "At B = -28.6479°" in remark
