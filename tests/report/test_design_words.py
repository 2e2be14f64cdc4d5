"""The verdict of a design speaks of the user's workspace, and of rivals that can be built."""

from types import SimpleNamespace

import numpy as np
import pytest

from matstd.artefact.place import Family, FamilyFigures
from matstd.report.words import best_rival, design_lines, shown_line, verdict_of_design
from matstd.report.words.design_words import AT_20, blind_spots, proof_sentence
from matstd.report.words.family_words import family_line
from matstd.twin.machine import Axis, Chain, make_chain
from matstd.twin.units import UM


def placement(own: float, spheres: float, block: float = 9.0, scatter: float = 0.1):
    """Errors left in the workspace, µm; in the probed volume the order is the other way round."""
    names = ("standard A", "four spheres", "block", "ideal scatter")
    rivals = tuple(
        SimpleNamespace(
            name=name,
            rms_user=left * UM,
            rms=10.0 * UM / left,
            body=None
            if name.startswith("ideal")
            else SimpleNamespace(patches=() if "spheres" in name else ("FF1",)),
        )
        for name, left in zip(names, (own, spheres, block, scatter), strict=True)
    )
    power = SimpleNamespace(touches=160, power=np.array([0.9, 1.0]), found=1, effects=("a", "b"))
    body = SimpleNamespace(patches=("FF1", "FF2"), proving=("FF1", "FF2"))
    return SimpleNamespace(
        own=rivals[0],
        rivals=rivals,
        power=power,
        power_in_volume=power,
        power_of_balls=power,
        power_exact=power,
        standard=body,
        families=(),
        family=Family.FACES,
    )


@pytest.mark.parametrize(
    ("own", "spheres", "said"),
    [
        (1.0, 2.0, "would leave 2.00 µm, 2.0 times as much"),
        (1.0, 1.01, "the best other artefact, four spheres, is equal: 1.01 µm"),
        (2.0, 1.0, "Another artefact is better there: four spheres would leave 1.00 µm, 2.0 times"),
    ],
)
def test_the_verdict_is_on_the_workspace(own: float, spheres: float, said: str) -> None:
    made = placement(own, spheres)
    words = verdict_of_design(made, {})
    assert words.startswith(
        f"After probing the standard A, the tool point is known to {own:.2f} µm rms"
    )
    assert "in your workspace" in words
    assert said in words


def test_scatter_that_cannot_be_built_is_no_rival() -> None:
    assert best_rival(placement(1.0, 2.0)).name == "four spheres"
    alone = placement(1.0, 2.0)
    alone.rivals = (alone.own, alone.rivals[-1])
    assert best_rival(alone) is None
    assert verdict_of_design(alone, {}).endswith(f"in your workspace (predicted). {AT_20}")


def test_the_probed_volume_comes_second_and_by_name() -> None:
    first, second, _ = design_lines(placement(1.0, 2.0), {})
    proof = proof_sentence(placement(1.0, 2.0))
    assert "160 touches on 2 freeform faces" in proof
    assert "average power of 95 %" in proof
    assert "for 1 of 2 effects" in proof
    assert "probed volume" not in first
    assert "probed volume" in second
    assert "block, would leave 1.11 µm" in second


def test_faces_are_weighed_against_spheres_by_what_they_cost_or_gain() -> None:
    gain, cost = (design_lines(placement(own, 1.0), {})[2] for own in (0.5, 1.32))
    assert "2 freeform faces gain 50 % over your workspace" in gain
    assert "2 freeform faces cost 32 % over your workspace" in cost
    assert "leaves 1.32 µm rms; four spheres, placed by the same optimiser, leave 1.00 µm" in cost


@pytest.mark.parametrize(
    ("goal", "built", "signals", "lefts", "said"),
    [
        ("prove", Family.WAVY, (10.0, 12.5), (1.0, 1.01), "it is 25 % better than the next, balls"),
        ("prove", Family.WAVY, (10.0, 9.7), (1.0, 1.0), "balls alone would be 3.1 % better, less"),
        ("prove", Family.BALLS, (10.0, 14.0), (1.0, 1.3), "but would leave 30 % more unknown"),
        ("identify", Family.BALLS, (10.0, 14.0), (1.0, 1.3), "it is 30 % better than the next"),
    ],
)
def test_the_first_line_says_which_family_wins_and_by_how_much(
    goal, built, signals, lefts, said
) -> None:
    made = placement(1.0, 2.0)
    made.goal, made.family = goal, built
    face = SimpleNamespace(half_size=(90.0, 90.0))
    balls = [SimpleNamespace(proves=k > 12) for k in range(15)]
    made.standard = SimpleNamespace(
        patches=(face,) if built is Family.WAVY else (),
        proving=("FF1",) if built is Family.WAVY else ("SPH14", "SPH15"),
        spheres=balls[: 13 if built is Family.WAVY else 15],
    )
    made.families = tuple(
        FamilyFigures(family, rms_user=left * UM, signal=signal, least=(True, 40.0, "Y"))
        for family, signal, left in zip((Family.BALLS, Family.WAVY), signals, lefts, strict=True)
    )
    made.requests, made.proof = range(480), range(110)
    line = family_line(made)
    assert "(480 that identify, 110 that prove) the effect" in line
    begin = "one wavy face of 180 x 180 mm" if built is Family.WAVY else "2 balls that prove"
    assert line.startswith(f"Built: 13 balls and {begin}. For ")
    assert said in line
    # a page begins with it where it is why the face was built
    first = shown_line(made)
    assert first.startswith("After") == (built is Family.WAVY)
    assert first.removesuffix(".") in line


@pytest.mark.parametrize(
    ("exact", "blame"),
    [
        ([0.99, 0.97, 0.96, 0.9, 1.0], "a better calibration of these features would help"),
        ([0.99, 0.9, 0.9, 0.9, 1.0], "their slopes and places are another"),
        ([0.6, 0.7, 0.5, 0.9, 1.0], "the touches are hardly sensitive to these effects"),
    ],
)
def test_what_the_proof_does_not_find_is_named_with_the_cause(exact, blame) -> None:
    made, names = placement(1.0, 2.0), ("a", "b", "c", "d", "e")
    made.power = SimpleNamespace(
        touches=160, power=np.array([0.5, 0.6, 0.4, 0.9, 1.0]), found=1, effects=names
    )
    found = int(np.sum(np.array(exact) >= 0.95))
    made.power_exact = SimpleNamespace(
        touches=160, power=np.array(exact), found=found, effects=names
    )
    last = blind_spots(made)
    assert last.startswith("Power below 95 %: c (40 %), a (50 %), b (60 %) and d (90 %).")
    assert f"{found} of 5 effects would be detected" in last
    assert blame in last
    made.power = SimpleNamespace(touches=160, power=np.full(5, 0.96), found=5, effects=names)
    assert blind_spots(made) == ""


def test_a_workspace_beyond_the_touches_is_reported_by_axis(chain: Chain) -> None:
    made = placement(1.0, 2.0)
    read = np.zeros((2, len(chain.axes)))
    read[:, [chain.axis_index(axis) for axis in "XYB"]] = [
        [-100.0, -80.0, 0.0],
        [90.0, 120.0, np.pi / 18.0],
    ]
    made.requests = ()
    made.criterion = SimpleNamespace(
        reach=SimpleNamespace(chain=chain, readings=lambda _requests: read)
    )
    asked = {"X": (-400.0, 400.0), "Y": (-100.0, 100.0), "B": (-np.pi / 2.0, 0.0)}
    words = verdict_of_design(made, asked)
    assert (
        "The touches cover only X -100 to 90 mm (workspace -400 to 400) and "
        "B 0 to 10° (workspace -90 to 0). Beyond these readings the model extrapolates" in words
    )
    assert "errors; a smaller workspace or further set-ups reduce the uncertainty." in words
    # a tilting head over a standard that is too low; its C, along the spindle, needs no riser
    axes = {"X": Axis((-400.0, 400.0))} | {a: Axis((-2.0, 2.0), (0.0, 0.0, 200.0)) for a in "CB"}
    head = make_chain("head", "[w f X C B t]", axes)
    made.criterion.reach = SimpleNamespace(chain=head, readings=lambda _requests: np.zeros((2, 3)))
    words = verdict_of_design(made, {"B": (-1.0, 1.0), "C": (-1.0, 1.0)})
    assert "further set-ups or for B a riser under the standard reduce the uncertainty" in words
    made.criterion.reach = SimpleNamespace(chain=chain, readings=lambda _requests: read)
    most = {"X": (-120.0, 120.0)}
    assert verdict_of_design(made, most) == verdict_of_design(made, {})
    made.own.rms = made.own.rms_user / 10.0  # far worse known than what was probed
    assert "only X -100 to 90 mm (workspace -120 to 120)" in verdict_of_design(made, most)
    inside = {"X": (-100.0, 90.0), "Y": (-80.0, 120.0)}
    assert verdict_of_design(made, inside) == verdict_of_design(made, {})
