"""Pictures that no small example shows: each of a result made by hand, whole."""

import numpy as np
import pytest
from machines import HSM600U, LATHE, TURNING
from unchanged import drawn

from matstd.artefact.feasibility import Room
from matstd.artefact.layout import Blank
from matstd.artefact.reach import ANGLE, Limit, PlacesInReach
from matstd.diagnosis.fit import fit_run
from matstd.report.plots import draw_form, draw_reach, draw_room, is_form
from matstd.twin.library import ordinary_model, parse_effect
from matstd.twin.model import Model
from matstd.twin.units import DEG


@pytest.mark.parametrize("chain", [HSM600U, TURNING, LATHE], ids=lambda c: c.name.split()[0])
def test_reach(chain, unchanged) -> None:
    """Four places at three poses; travels and the angle bar some of them."""
    rng, turns = np.random.default_rng(2), len(chain.rotary_axes)
    beyond = np.round(np.maximum(rng.normal(-0.3, 1.0, (4, 3, 2)), 0.0), 2)
    beyond[3] += 1.0
    limits = (Limit("X", 400.0), Limit(ANGLE, 60.0 * DEG))
    point = np.array([[0, 0, 50.0], [40, -30, 80], [-60, 20, 30], [70, 70, 90]])
    poses = np.array([[-1.0, 0.5], [0.2, 2.0], [-0.4, -1.0]])[:, :turns]
    reach = PlacesInReach(point, np.tile([0, 0, 1.0], (4, 1)), poses, limits, beyond)
    unchanged(drawn(draw_reach(reach, chain, Blank())) + "\n")


def test_room(upright, unchanged) -> None:
    room = Room(Blank(), 6, 200, 150, upright.patches, upright.spheres)
    unchanged(drawn(draw_room(room)) + "\n")


def test_form_of_a_face(case, unchanged) -> None:
    run = case(33, "hmc1995").run
    effect = parse_effect(f"artefact-form({run.touches.feature[0]})", run.touches.chain)
    fit = fit_run(
        run, Model(run.touches.chain, (*ordinary_model(run.touches.chain).effects, effect))
    )
    assert is_form(fit, effect)
    unchanged(drawn(draw_form(fit, effect)) + "\n")
