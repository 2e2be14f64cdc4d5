"""Body, balls and screws: the rules of the details, and the files read by other readers."""

import re
import zipfile
from dataclasses import replace
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest

from matstd.artefact.body import BLEND
from matstd.cad_out.details import (
    DOT,
    RELIEF,
    Tolerance,
    datum_touches,
    details_of,
    engraved_on,
    glue_gap,
    notes_of,
)
from matstd.cad_out.details.places import plan_room
from matstd.cad_out.details.seats import seat_of
from matstd.cad_out.meshes import ball_mesh, inner_folds, mesh_volume
from matstd.cad_out.verify.part21 import read_entities, read_faces, read_instances
from matstd.cad_out.verify.part21_tolerances import (
    missing_annotations,
    read_notes,
    read_signs,
    read_tolerances,
)
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import apply, pose


def test_a_ball_touches_its_countersink_in_one_circle_and_the_post_stays_in_its_cone(upright):
    for sphere in upright.spheres:
        seat = seat_of(sphere)
        # the centre is a radius away from the countersink's flank, by the sine of its angle
        depth = sphere.centre[2] - seat.bottom
        assert depth * np.sin(seat.half_angle) == pytest.approx(sphere.radius, abs=1e-9)
        r = np.linspace(0.0, seat.rim_radius, 400)
        flank = seat.bottom + r / np.tan(seat.half_angle)
        ball = sphere.centre[2] - np.sqrt(sphere.radius**2 - r**2)
        assert (ball - flank).min() > -1e-9
        assert abs(r[np.argmin(ball - flank)] - seat.contact_radius) < 0.05
        assert flank[-1] == pytest.approx(seat.top)
        assert 0.05 < glue_gap(sphere, seat) < 0.5
        taper = (sphere.foot_radius - sphere.stem_radius) / (sphere.centre[2] - sphere.foot)
        assert seat.top_radius <= sphere.stem_radius + taper * (sphere.centre[2] - seat.top) + 1e-9
    with pytest.raises(NotBuildable, match=r"SPH1: a post of 2 mm radius is too thin"):
        seat_of(replace(upright.spheres[0], stem_radius=2.0, foot_radius=2.0))


def test_a_foot_that_is_rounded_keeps_the_distance_that_a_circle_has(upright):
    """By hand: a point at (d, z) from wall and plate is R - |(R - d, R - z)| from the blend."""
    (patch, *_), top = upright.patches, upright.base.thickness
    wall = patch.T_artefact_patch[:3, 3] + [patch.half_size[0], 0.0, 0.0]
    at = np.array(
        [[wall[0] + d, wall[1], top + z] for d, z in ((1.0, 1.0), (2.5, 1.0), (4.0, 0.5))]
    )
    by_hand = [BLEND - np.hypot(2.0, 2.0), BLEND - np.hypot(0.5, 2.0), 0.5]
    assert upright.distance(at) == pytest.approx(by_hand, abs=1e-9)
    assert upright.blended == {"FF1", "FF2", "SPH1", "SPH2", "SPH3"}


@pytest.mark.parametrize(("room", "is_rounded"), [(0.4, False), (0.7, True)])
def test_a_foot_is_rounded_where_the_blend_keeps_half_a_millimetre_from_the_rim(
    upright, room, is_rounded
):
    rim = np.array(upright.base.half_size) - BLEND - room
    patch, ball = upright.patches[1], upright.spheres[2]
    T = patch.T_artefact_patch.copy()
    T[1, 3] = rim[1] - patch.half_size[1]
    moved = replace(patch, T_artefact_patch=T)
    beside = replace(ball, centre=np.array([rim[0] - ball.foot_radius, *ball.centre[1:]]))
    made = replace(
        upright, patches=(upright.patches[0], moved), spheres=(*upright.spheres[:2], beside)
    )
    assert ({"FF2", "SPH3"} <= made.blended) == is_rounded
    assert made.blended >= {"FF1", "SPH1", "SPH2"}
    assert len(made.blended) == (5 if is_rounded else 3)


def test_lettering_stands_clear_of_bodies_holes_and_each_other(upright):
    details = details_of(upright)
    assert details.missing == ()
    named = {line.of for line in details.lettering}
    features = {*upright.features, "DATUM_B", "DATUM_C"}
    assert named - {""} == features
    top, boxes = upright.base.thickness, []
    for line in details.lettering:
        ink = line.dots
        where = apply(line.T_artefact_text, np.column_stack([ink, np.zeros(len(ink))]))
        if np.allclose(where[:, 2], top):
            assert plan_room(upright, where[:, :2]).min() > 1.0
            boxes.append((where[:, :2].min(axis=0), where[:, :2].max(axis=0)))
        else:
            assert where[:, 2].max() < upright.blank_height - 1.0
            assert where[:, 2].min() > RELIEF
    for touched, _ in datum_touches(upright).values():
        assert np.linalg.norm(engraved_on(upright)[:, None] - touched, axis=-1).min() > 5.0
    for k, (low, high) in enumerate(boxes):
        for a, b in boxes[:k]:
            assert (np.maximum(low - b, a - high) > 2.0 * DOT).any()


def test_heavy_standards_are_lifted_beside_their_centre_of_mass(upright):
    assert [bore.name for bore in details_of(upright).bores] == ["THERMO"]
    lead = replace(upright, material=replace(upright.material, density=5e-5))
    one, other = (np.array(b.mouth) for b in details_of(lead).bores if b.thread)
    assert np.linalg.norm(one - other) >= 80.0
    assert np.linalg.norm(0.5 * (one + other)[:2]) < 15.0


def test_the_product_structure_is_body_balls_and_screws(upright, built):
    found = read_instances(read_entities(built[0] / "standard.step"))
    assert set(found) == {"BODY", "SPH1", "SPH2", "SPH3", *(f"SCREW_HOLE{i}" for i in (1, 2, 3))}
    assert found["SPH2"].about == "Ball D25, ISO 3290-1 G5, bought"
    floor = upright.base.thickness - upright.holes[0].bore_depth
    for hole in upright.holes:
        screw = found[f"SCREW_{hole.name}"]
        assert screw.product == "ISO 4762 M10x30"  # 14 mm clamped, 15 mm in the nut
        assert screw.moved == pytest.approx((hole.x, hole.y, floor))
    assert built[1].products["ISO 4762 M10x30"] == 3
    assert built[1].sharp == 0.0


def test_a_body_without_blends_has_inner_edges(upright):
    """Two boxes, one on the other: the foot is 4 x 20 mm long, all else is convex."""
    trimesh = pytest.importorskip("trimesh")
    low = trimesh.creation.box((60.0, 60.0, 10.0))
    high = trimesh.creation.box((20.0, 20.0, 10.0), pose(t=np.array([0.0, 0.0, 8.0])))
    whole = trimesh.boolean.union([low, high], engine="manifold")
    _, length = inner_folds(np.array(whole.vertices), np.array(whole.faces), 0.6)
    assert length.sum() == pytest.approx(80.0)


def test_balls_have_triangles_of_nearly_one_size(upright):
    mesh = ball_mesh(upright.spheres[0], 0.01)
    sides = mesh.corners[mesh.triangles] - mesh.corners[np.roll(mesh.triangles, 1, axis=1)]
    length = np.linalg.norm(sides, axis=-1)
    assert length.max() < 1.6 * length.min()
    assert mesh_volume(mesh.corners, mesh.triangles) == pytest.approx(
        4.0 / 3.0 * np.pi * upright.spheres[0].radius ** 3, rel=2e-3
    )


def test_3mf_is_read_by_the_consortiums_own_library(built):
    lib3mf = pytest.importorskip("lib3mf")
    library = lib3mf.get_wrapper() if hasattr(lib3mf, "get_wrapper") else lib3mf.Wrapper()
    model = library.CreateModel()
    reader = model.QueryReader("3mf")
    reader.ReadFromFile(str(built[0] / "standard.3mf"))
    assert reader.GetWarningCount() == 0
    items = model.GetBuildItems()
    assert items.Count() == 7
    meshes = model.GetMeshObjects()
    names, triangles = [], 0
    while meshes.MoveNext():
        one = meshes.GetCurrentMeshObject()
        assert one.IsManifoldAndOriented()
        names.append(one.GetName())
        triangles += one.GetTriangleCount() if names[-1].startswith(("SPH", "small")) else 0
    assert names == ["small 0007 BODY", "SPH1", "SPH2", "SPH3", "ISO 4762 M10x30"]
    assert triangles == built[1].triangles
    # and its colours, by a reader of XML
    with zipfile.ZipFile(built[0] / "standard.3mf") as archive:
        root = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    colours = {e.get("displaycolor") for e in root.iter() if e.tag.endswith("}base")}
    assert {"#2166BF", "#CC261F", "#299947"} <= colours


def test_gltf_stands_upright_in_metres(upright, built):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load_scene(built[0] / "standard.glb")
    low, high = scene.bounds
    a, b = upright.base.half_size
    assert (high - low)[[0, 2]] == pytest.approx([2e-3 * a, 2e-3 * b], rel=1e-6)
    top = max(s.centre[2] + s.radius for s in upright.spheres)
    assert high[1] == pytest.approx(1e-3 * top, abs=1e-5)
    assert {name.split()[0] for name in scene.graph.nodes_geometry} >= {"BODY", "SPH3"}


def test_tolerances_datums_and_notes_are_in_the_text(upright, built):
    entities = read_entities(built[0] / "standard.step")
    found = read_tolerances(entities)
    assert Tolerance("FF2", "profile", 0.05, "ABC") in found
    assert Tolerance("SPH3_SEAT", "profile", 0.2, "ABC") in found
    assert Tolerance("DATUM_C", "perpendicularity", 0.02, "AB") in found
    assert len(found) == 3 + 3 + 2 + 3
    assert read_notes(entities) == list(notes_of(upright, details_of(upright)))
    assert built[1].misread == ()
    text = (built[0] / "standard.step").read_text()
    assert text.count("DIMENSIONAL_SIZE(") == len(upright.spheres)
    stated = re.findall(r"LENGTH_MEASURE\(([\d.E+]+)\)[^;]*'nominal value'", text)
    size = [float(value) for value in stated]
    assert size == pytest.approx([2.0 * sphere.radius for sphere in upright.spheres])
    assert "RUNOUT" not in text
    # a letter exchanged is a tolerance lost
    other = {k: e.replace(",'C')", ",'D')") if "DATUM(" in e else e for k, e in entities.items()}
    assert Tolerance("FF2", "profile", 0.05, "ABC") not in read_tolerances(other)


def test_signs_are_drawn_in_planes_beside_the_plate_and_point_at_their_faces(upright, built):
    """From the file's text: where leaders end by hand, room between frames, ink in one plane."""
    entities = read_entities(built[0] / "standard.step")
    signs = read_signs(entities)
    said = {f"{t.face} {t.kind}" for t in read_tolerances(entities)}
    balls = {f"{sphere.name} diameter" for sphere in upright.spheres}
    assert set(signs) == said | balls | {"datum A", "datum B", "datum C"}
    ends = {name: sign[1][-1] for name, sign in signs.items()}
    (patch, *_), (ball, *_), base = upright.patches, upright.spheres, upright.base
    off = ends["FF1 profile"] - patch.T_artefact_patch[:3, 3]
    height = patch.height(off[None, :2])[0]  # an upright patch: its own x and y are the body's
    assert off[2] == pytest.approx(height, abs=1e-6)
    assert np.linalg.norm(ends["SPH1 diameter"] - ball.centre) == pytest.approx(ball.radius)
    assert np.linalg.norm(ends["SPH1_SEAT profile"] - ball.centre) == pytest.approx(ball.radius)
    assert ends["datum A"][2] == ends["DATUM_A flatness"][2] == base.thickness
    assert ends["datum B"][1] == ends["DATUM_B perpendicularity"][1] == -base.half_size[1]
    assert ends["datum C"][0] == -base.half_size[0]
    assert ends["SEAT1 parallelism"][2] == 0.0
    frames = []
    for sign in signs.values():
        assert np.ptp(np.concatenate(sign)[:, 2]) == 0.0
        low, high = sign[0].min(axis=0)[:2], sign[0].max(axis=0)[:2]
        assert np.abs([low[0], high[0]]).min() > base.half_size[0] + 20.0
        frames.append((low, np.maximum(high, low + 10.0)))
    for k, (low, high) in enumerate(frames):
        assert all((np.maximum(low - b, a - high) > 2.0).any() for a, b in frames[:k])


def test_a_sign_that_is_lost_is_reported(upright, built):
    entities = read_entities(built[0] / "standard.step")
    details = details_of(upright)
    kernel = {name: _length_and_middle(s) for name, s in read_signs(entities).items()}
    found = {
        "tolerances": [tuple(t) for t in read_tolerances(entities)],
        "notes": read_notes(entities),
        "signs": kernel,
    }
    assert missing_annotations(upright, details, entities, found) == ()
    kernel["FF1 profile"] = [1.0, 0.0, 0.0, 0.0]
    without = "DRAUGHTING_CALLOUT('datum A'"
    entities = {k: e.replace(without, "DRAUGHTING_CALLOUT(''") for k, e in entities.items()}
    assert set(missing_annotations(upright, details, entities, found)) == {
        "sign of FF1 profile",
        "sign of datum A",
    }


def _length_and_middle(strokes):
    """By loops over the pieces of every line."""
    length, middle = 0.0, np.zeros(3)
    for stroke in strokes:
        for begin, end in pairwise(stroke):
            length += np.linalg.norm(end - begin)
            middle = middle + np.linalg.norm(end - begin) * 0.5 * (begin + end)
    return [length, *middle / length]


def test_every_face_of_the_body_is_a_part_in_a_file_of_its_own(upright, built):
    """What programs without names of faces show; the same surface as in the whole standard."""
    entities = read_entities(built[0] / "standard-faces.step")
    parts, body = read_instances(entities), set(built[1].names) - {s.name for s in upright.spheres}
    assert set(parts) == {part.product for part in parts.values()} == body
    assert not any("MANIFOLD_SOLID_BREP(" in entity for entity in entities.values())
    alone = read_faces(built[0] / "standard-faces.step", entities)
    whole = read_faces(built[0] / "standard.step")
    assert set(alone) == body
    for patch in upright.patches:
        assert np.array_equal(alone[patch.name].poles, whole[patch.name].poles)


@pytest.mark.parametrize("inset", [0.0, 1.0, 1.24, 2.0, 2.74, 5.0])
def test_relief_beside_a_pad_is_never_a_strip(upright, inset):
    """A hole 5 mm and more from the outline; flanks end sqrt(3^2 - 2^2) mm beyond their pad."""
    hole, base = upright.holes[0], upright.base
    x = base.half_size[0] - hole.bore_radius - 5.0 - inset
    moved = replace(upright, holes=(replace(hole, x=x, y=0.0), *upright.holes[1:]))
    pad = details_of(moved).pads[0]
    assert base.half_size[0] - x - pad.radius - np.sqrt(5.0) >= 1.5 - 1e-9
    assert hole.bore_radius + 1.2 < pad.radius <= hole.bore_radius + 4.0
