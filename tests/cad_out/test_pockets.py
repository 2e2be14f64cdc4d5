"""No closed pocket stays inside a standard: no tool could cut it."""

import math

import pytest


def test_a_closed_pocket_is_filled_and_the_outside_stays():
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt

    from matstd.cad_out.kernel.faces import is_closed, is_valid, shells_of, solids_of, volume
    from matstd.cad_out.kernel.solid import without_pockets

    box = BRepPrimAPI_MakeBox(10.0, 10.0, 10.0).Shape()
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(5.0, 5.0, 5.0), 3.0).Shape()
    hollow = solids_of(BRepAlgoAPI_Cut(box, ball).Shape())[0]
    assert len(shells_of(hollow)) == 2
    assert volume(hollow) == pytest.approx(1000.0 - 36.0 * math.pi, rel=1e-9)
    filled = without_pockets(hollow)
    assert len(shells_of(filled)) == 1
    assert volume(filled) == pytest.approx(1000.0, rel=1e-9)
    assert is_valid(filled)
    assert is_closed(filled)
