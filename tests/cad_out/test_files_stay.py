"""The files of a built standard are what they were when they were looked at."""

import json
import re
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from unchanged import Unchanged, facts, folded, summary

from matstd.artefact.body import Base
from matstd.cad_out.details import (
    annotations_of,
    datum_touches,
    details_of,
    engraved_on,
    notes_of,
    tolerances_of,
)
from matstd.cad_out.details.places import Side
from matstd.cad_out.making import joints_of, stiffness_of
from matstd.cad_out.making.cutting import cutting_of
from matstd.cad_out.making.hints import hints_of
from matstd.cad_out.meshes import mesh_volume
from matstd.cad_out.verify.conformity import write_conformity
from matstd.twin.sampling import grid_points


def entities(text: str) -> str:
    """Entities of a STEP file without their numbers, a line each, lengths to 0.1 µm."""
    text = re.sub(r"\n *", "", text).replace(";", "\n")
    # the kernel counts the occurrences of all assemblies that a process makes
    text = re.sub(
        r"(?<!')#\d+,?|(?<=material-standard) [\d.]+|(?<=USAGE_OCCURRENCE\(')\d+", "", text
    )
    return re.sub(
        r"(?<=[(,])-?\d+\.\d*(?:E-?\d+)?", lambda m: f"{round(float(m[0]), 4) + 0.0:.4f}", text
    )


def archived(path: Path) -> str:
    """Texts of an archive, a tag a line."""
    with zipfile.ZipFile(path) as archive:
        texts = [f"{name}\n{archive.read(name).decode()}" for name in archive.namelist()]
    return "\n".join(texts).replace("><", ">\n<")


def chunk(path: Path) -> str:
    """What a GLB file says of its buffers."""
    data = path.read_bytes()
    return json.dumps(json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")]), indent=1)


def test_a_foreign_step_file_is_meshed_whole(upright, built) -> None:
    """All bodies of the file, balls and screws too, with the outside outwards."""
    from matstd.cad_out.kernel.faces import faces_of, volume
    from matstd.cad_out.kernel.reader import read_shape, tessellate

    shape = read_shape(built[0] / "standard.step")
    corners, triangles, owner = tessellate(shape, 0.1)
    assert volume(shape) > built[1].volume  # the screws belong to the assembly alone
    assert mesh_volume(corners, triangles) == pytest.approx(volume(shape), rel=2e-3)
    assert np.array_equal(np.unique(owner), np.arange(len(faces_of(shape))))


def test_a_rational_spline_is_evaluated_as_the_kernel_does() -> None:
    """A quarter of a cylinder as a spline: every point is at its radius from the axis."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    from matstd.cad_out.kernel.faces import faces_of
    from matstd.cad_out.kernel.reader import _in_space

    solid = BRepPrimAPI_MakeCylinder(7.0, 20.0, 0.5 * np.pi).Shape()
    faces = faces_of(BRepBuilderAPI_NurbsConvert(solid, True).Shape())
    surfaces = [BRepAdaptor_Surface(face) for face in faces]
    (curved,) = [s for s in surfaces if s.BSpline().IsURational() or s.BSpline().IsVRational()]
    u = np.linspace(curved.FirstUParameter(), curved.LastUParameter(), 7)
    v = np.linspace(curved.FirstVParameter(), curved.LastVParameter(), 5)
    found = _in_space(curved)(grid_points(u, v))
    assert np.hypot(*found[:, :2].T) == pytest.approx(7.0, abs=1e-12)
    assert np.ptp(found, axis=0) == pytest.approx([7.0, 7.0, 20.0])


@pytest.mark.parametrize(
    ("normal", "offset", "removed"),
    [((1, 0), 59.0, 85.0), ((-1, 0), 48.0, 170.0), ((0, 1), 42.0, 330.0), ((0, -1), 36.0, 440.0)],
)
def test_a_flat_is_what_lies_beyond_its_side(normal, offset, removed) -> None:
    """Of a block from (-50, -40) to (60, 45), 20 mm high; areas by hand, mm^2."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    from matstd.cad_out.kernel.faces import volume
    from matstd.cad_out.kernel.primitives import boolean, box
    from matstd.cad_out.kernel.solid import _flat_cut

    block = box([-50.0, -40.0, 0.0], [60.0, 45.0, 20.0])
    tool = _flat_cut(Side(normal, offset, 30.0, 0.5), Base((60.0, 45.0), 45.0, 20.0))
    left = boolean(BRepAlgoAPI_Cut(), [block], [tool], "a flat")
    assert volume(block) - volume(left) == pytest.approx(20.0 * removed)


@pytest.mark.parametrize(
    "name",
    ["standard.step", "standard-faces.step", "standard-parts.step", "standard.3mf", "standard.glb"],
)
def test_a_file_is_what_it_was(built, unchanged: Unchanged, name: str) -> None:
    """Lines of the same words in one."""
    path = built[0] / name
    match path.suffix:
        case ".3mf":
            text = archived(path)
        case ".glb":
            text = chunk(path)
        case _:
            text = entities(path.read_text(encoding="utf-8"))
    unchanged(folded(text))


def test_figures_and_triangles_are_what_they_were(built, tmp_path, unchanged: Unchanged) -> None:
    """The conformity; of every face its triangles, their corners and their area."""
    _, conformity, mesh = built
    write_conformity(tmp_path / "conformity.json", conformity)
    lines = [folded((tmp_path / "conformity.json").read_text(encoding="utf-8"))]
    for name in sorted(set(mesh.owner)):
        corners = mesh.corners[mesh.triangles[mesh.owner == name]]
        lines.append(f"'{name}' {summary(corners[..., 0])} {summary(corners[..., 1:])}")
    unchanged("\n".join(lines))


@pytest.mark.parametrize("name", ["standard", "upright", "on a disc"])
def test_details_and_making_are_what_they_were(request, name: str, unchanged: Unchanged) -> None:
    """Bores, pads, seats, letters, signs and notes; cutters, hints, stiffness, joints."""
    made = request.getfixturevalue("upright" if name == "on a disc" else name)
    if name == "on a disc":
        made = replace(made, base=Base((100.0, 100.0), 100.0, 28.0))
    details = details_of(made)
    drawn = tolerances_of(made, details), notes_of(made, details), annotations_of(made, details)
    lines = [facts((details, drawn, datum_touches(made), engraved_on(made)[::7]))]
    if name != "standard":  # its faces lean
        cut = cutting_of(made, details), hints_of(made), stiffness_of(made, details, 25.0)
        lines.append(facts((cut, joints_of(made, details))))
    unchanged(folded("\n".join(lines)))
