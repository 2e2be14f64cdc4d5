"""Triangles without needles: a box with a slanting bore and a cone, checked by trimesh."""

import numpy as np
import pytest

from matstd.cad_out.meshes import aspects
from matstd.cad_out.triangles import bisected
from matstd.cad_out.triangles.delaunay import Sheet, circumcircles, cross

CHORD = 0.02
R, DEEP, WIDE = 6.0, 8.0, 5.0  # mm: bore, countersink's depth and radius


@pytest.fixture(scope="module")
def drilled():
    """Corners, triangles and face numbers of a box with a bore through it and a countersink."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    from matstd.cad_out.kernel.reader import triangulate

    box = BRepPrimAPI_MakeBox(gp_Pnt(-40.0, -30.0, 0.0), gp_Pnt(40.0, 30.0, 25.0)).Shape()
    leaning = gp_Ax2(gp_Pnt(-20.0, 0.0, -20.0), gp_Dir(np.sin(0.4), 0.0, np.cos(0.4)))
    bore = BRepPrimAPI_MakeCylinder(leaning, R, 80.0).Shape()
    down = gp_Ax2(gp_Pnt(20.0, 5.0, 25.0), gp_Dir(0.0, 0.0, -1.0))
    tip = BRepPrimAPI_MakeCone(down, WIDE, 0.0, DEEP).Shape()
    shape = BRepAlgoAPI_Cut(BRepAlgoAPI_Cut(box, bore).Shape(), tip).Shape()
    return triangulate(shape, CHORD)


def test_the_mesh_is_closed_and_its_volume_that_of_the_formulas(drilled):
    trimesh = pytest.importorskip("trimesh")
    corners, triangles, _ = drilled
    mesh = trimesh.Trimesh(corners, triangles, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    by_hand = 80.0 * 60.0 * 25.0 - np.pi * R**2 * 25.0 / np.cos(0.4) - np.pi * WIDE**2 * DEEP / 3.0
    assert mesh.volume == pytest.approx(by_hand, rel=2e-4)


def test_no_triangle_is_a_needle(drilled):
    trimesh = pytest.importorskip("trimesh")
    corners, triangles, _ = drilled
    mesh = trimesh.Trimesh(corners, triangles, process=False)
    assert np.rad2deg(mesh.face_angles.min()) > 5.0
    sides = np.linalg.norm(mesh.triangles - np.roll(mesh.triangles, 1, axis=1), axis=2)
    assert aspects(corners, triangles) == pytest.approx(
        sides.max(axis=1) ** 2 / mesh.area_faces / 2
    )
    assert aspects(corners, triangles).max() < 12.0


def test_triangles_keep_the_chord(drilled):
    corners, triangles, numbers = drilled
    middle = corners[triangles].mean(axis=1)
    axis, place = np.array([np.sin(0.4), 0.0, np.cos(0.4)]), np.array([-20.0, 0.0, -20.0])
    from_axis = np.linalg.norm(np.cross(middle - place, axis), axis=1)
    inner = np.unique(numbers[np.abs(from_axis - R) < 0.1])
    bore = np.isin(numbers, inner)
    assert bore.sum() > 200
    assert np.abs(from_axis[bore] - R).max() < CHORD
    x, y, z = (middle - [20.0, 5.0, 25.0 - DEEP]).T
    off = np.abs(np.hypot(x, y) - z * WIDE / DEEP) / np.hypot(1.0, WIDE / DEEP)
    cone = np.isin(numbers, numbers[np.hypot(x, y) + np.abs(z) < 1.0])
    assert off[cone].max() < CHORD


def test_the_inside_of_an_outline_with_a_hole():
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    places = np.concatenate([square, 0.25 * square + 1.5])
    ring = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    sheet = Sheet(places, np.concatenate([ring, ring + 4]))
    assert not sheet.lost.any()
    a, b, c = (places[sheet.triangles[:, k]] for k in range(3))
    assert 0.5 * cross(b - a, c - a).sum() == pytest.approx(15.0)
    assert sheet.contains(np.array([[0.5, 0.5], [2.0, 2.0], [5.0, 1.0]])).tolist() == [
        True,
        False,
        False,
    ]


def test_a_piece_that_is_no_side_is_found():
    places = np.array([[0.0, 0.0], [4.0, 0.0], [2.0, 0.3], [2.0, -0.3]])
    assert Sheet(places, np.array([[0, 1], [0, 2], [2, 1]])).lost.tolist() == [True, False, False]


def test_rational_splines_are_followed():
    """A box with a bore whose faces the kernel has turned into rational B-splines."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    from matstd.cad_out.kernel.reader import farthest_from_faces, triangulate

    trimesh = pytest.importorskip("trimesh")
    box = BRepPrimAPI_MakeBox(gp_Pnt(-20.0, -15.0, 0.0), gp_Pnt(20.0, 15.0, 10.0)).Shape()
    upright = gp_Ax2(gp_Pnt(3.0, 2.0, -5.0), gp_Dir(0.0, 0.0, 1.0))
    bored = BRepAlgoAPI_Cut(box, BRepPrimAPI_MakeCylinder(upright, R, 30.0).Shape()).Shape()
    shape = BRepBuilderAPI_NurbsConvert(bored).Shape()
    corners, triangles, numbers = triangulate(shape, CHORD)
    mesh = trimesh.Trimesh(corners, triangles, process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(40.0 * 30.0 * 10.0 - np.pi * R**2 * 10.0, rel=2e-4)
    assert farthest_from_faces(shape, corners, triangles, numbers) < CHORD


def test_the_circle_through_a_triangle_of_6_8_10():
    right = np.array([[0.0, 0.0], [6.0, 0.0], [0.0, 8.0]])
    centre, radius = circumcircles(np.stack([right, right + np.array([1.0, 2.0]), right[::-1]]))
    np.testing.assert_allclose(centre, [[3.0, 4.0], [4.0, 6.0], [3.0, 4.0]])
    np.testing.assert_allclose(radius, 5.0)


def test_a_curve_is_halved_where_it_leaves_its_secant_too_far():
    # a straight line does not; a quarter of a circle of 10 mm does by 2.93 mm, an eighth by 0.76
    ends = np.array([0.0, 1.0])
    line = bisected(lambda t: np.outer(t, [30.0, 40.0, 0.0]), ends, 0.1)
    np.testing.assert_array_equal(line, ends)

    def quarter(t):
        angle = 0.5 * np.pi * t
        return 10.0 * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * t])

    np.testing.assert_array_equal(bisected(quarter, ends, 1.0 / 0.75), [0.0, 0.5, 1.0])
    np.testing.assert_array_equal(bisected(quarter, ends, 3.0 / 0.75), ends)
