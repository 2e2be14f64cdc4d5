"""STEP and STL of built standards, read anew; refusals and crashes leave nothing behind."""

import hashlib
import json
import re
from dataclasses import fields, replace
from importlib.metadata import version

import numpy as np
import pytest
import volume_by_hand
from standards import kernel_here

from matstd import cad_out
from matstd.artefact.body import DatumSphere
from matstd.cad_out.details import details_of
from matstd.cad_out.kernel import process, run_apart
from matstd.cad_out.kernel.exchange import with_units_of_density
from matstd.cad_out.kernel.process import Ending
from matstd.cad_out.meshes import (
    Mesh,
    chord_errors,
    is_watertight,
    manifold_volume,
    mesh_volume,
    owners,
    read_stl,
)
from matstd.cad_out.verify.conformity import ASPECT_LIMIT, FACE_LIMIT, face_names
from matstd.cad_out.verify.face_figures import face_deviations
from matstd.cad_out.verify.part21 import SphereFace, SplineFace, read_faces
from matstd.twin.errors import BadFile, DesignError, NotBuildable
from matstd.twin.units import NM, UM

FILES = tuple(f"standard{end}" for end in ("-faces.step", ".3mf", ".glb", ".step", ".stl"))


@pytest.mark.slow
def test_ten_patches_conform_and_stay_below_their_limits(standard, tmp_path):
    conformity = cad_out.verify.export_standard(standard, tmp_path, chord=0.02)
    files = ["conformity.json", *FILES]
    assert sorted(p.name for p in tmp_path.iterdir()) == files
    assert conformity.faults() == []
    assert conformity.solids == 1 + len(standard.spheres) + len(standard.holes)
    assert conformity.worst_face[1] < 1e-3 * FACE_LIMIT  # 14 digits of text leave 1e-8 um
    assert conformity.worst_chord[1] <= 0.02
    assert set(conformity.names) == set(face_names(standard, details_of(standard)))
    details = details_of(standard)
    less = volume_by_hand.recesses(standard, details) + volume_by_hand.seats(standard, details)
    assert conformity.volume == pytest.approx(standard.volume(2.0) - less, rel=1e-3)
    assert conformity.stl_bytes == (tmp_path / "standard.stl").stat().st_size < 6_000_000


def test_step_text_carries_units_schema_names_and_a_fixed_time(upright, built):
    place, conformity, _ = built
    text = (place / "standard.step").read_text()
    assert "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF" in text
    assert "'2000-01-01T00:00:00'" in text
    assert "PRODUCT('small 0007'" in text
    for name in face_names(upright, details_of(upright)):
        assert text.count(f"ADVANCED_FACE('{name}'") == 1
    assert upright.material.name in text
    assert conformity.is_millimetre
    assert conformity.faults() == []


def test_volume_is_that_of_textbook_formulas(upright, built):
    """Pillars by quadrature, posts, seats, blends, relief, bores, lettering: no kernel, no grid."""
    by_hand = volume_by_hand.of_upright(upright, details_of(upright))
    assert built[1].volume == pytest.approx(by_hand, rel=2e-5)


def test_the_parts_are_read_again(upright, built):
    place, conformity, _ = built
    kinds = {name: sum(name in part for part in conformity.parts) for name in ("STUD", "BLOCK")}
    assert kinds == {"STUD": len(upright.spheres), "BLOCK": len(upright.patches)}
    assert conformity.parts["PLATE"] == 1
    assert conformity.parts["SPH1"] == 1
    text = (place / "standard-parts.step").read_text()
    assert "PRODUCT('PLATE'" in text
    assert "PRODUCT('SPH1 STUD'" in text


def test_the_stl_has_no_needles(built):
    trimesh = pytest.importorskip("trimesh")
    place, conformity, _ = built
    mesh = trimesh.load_mesh(str(place / "standard.stl"))
    assert np.rad2deg(mesh.face_angles.min()) > 4.0
    sides = np.linalg.norm(mesh.triangles - np.roll(mesh.triangles, 1, axis=1), axis=2)
    ratio = sides.max(axis=1) ** 2 / (2.0 * mesh.area_faces)
    assert conformity.aspect == pytest.approx(ratio.max(), rel=1e-4)
    assert conformity.aspect < ASPECT_LIMIT
    assert conformity.body_chord_error <= conformity.chord


def test_poles_and_knots_in_the_file_are_those_of_the_design(upright, built):
    faces = read_faces(built[0] / "standard.step")
    for patch in upright.patches:
        face = faces[patch.name]
        assert isinstance(face, SplineFace)
        assert face.degree == patch.degree
        # the kernel may count u and v the other way round only if it says so by its degrees
        assert np.abs(face.poles - patch.poles).max() < NM
        assert np.abs(face.knots[0] - patch.knots_u).max() < NM
        assert np.abs(face.knots[1] - patch.knots_v).max() < NM
    for sphere in upright.spheres:
        face = faces[sphere.name]
        assert isinstance(face, SphereFace)
        assert np.abs(face.centre - sphere.centre).max() < NM
        assert face.radius == sphere.radius


def test_the_header_says_where_the_file_comes_from(upright, built):
    from matstd.cad_out.kernel.exchange import in_ascii

    place, _, _ = built
    header = re.sub(r"\s*\n\s*", "", (place / "standard.step").read_text().split("ENDSEC;")[0])
    design = hashlib.sha256((place / "standard.toml").read_bytes()).hexdigest()
    assert f"standard.toml{design}" in header.replace(" ", "")
    assert header.count("('not stated')") == 2
    assert f"material-standard {version('material-standard')}" in header
    assert in_ascii("Müller & Søn") == r"M\X2\00FC\X0\ller & S\X2\00F8\X0\n"


def test_density_has_the_dimension_of_a_density(upright, built):
    """Exponents of gram and centimetre, read from the text; the kernel's own are 3 and 2."""
    text = (built[0] / "standard.step").read_text()
    value, unit = re.search(
        r"'density',POSITIVE_RATIO_MEASURE\(\s*([\d.]+)\s*\),#(\d+)\)", text
    ).groups()
    assert float(value) == pytest.approx(upright.material.density * 1e6)
    elements = re.search(rf"\n#{unit} = DERIVED_UNIT\(\(#(\d+),#(\d+)\)\)", text).groups()
    found = [
        re.search(rf"\n#{e} = DERIVED_UNIT_ELEMENT\(#(\d+),([-\d.]+)\)", text).groups()
        for e in elements
    ]
    bases = [re.search(rf"\n#{base} = ([^;]*);", text)[1] for base, _ in found]
    assert "SI_UNIT($,.GRAM.)" in bases[0]
    assert "SI_UNIT(.CENTI.,.METRE.)" in bases[1]
    assert [float(power) for _, power in found] == [1.0, -3.0]
    with pytest.raises(NotBuildable, match="0 densities"):
        with_units_of_density("DATA;", 1)
    with pytest.raises(NotBuildable, match="another unit"):
        with_units_of_density(text, 3)


def test_a_pole_moved_by_a_tenth_of_a_micrometre_is_found(upright, built, tmp_path):
    text = (built[0] / "standard.step").read_text()
    entity = re.search(r"ADVANCED_FACE\('FF2',\([^)]*\),\s*#(\d+)", text)
    surface = re.search(rf"\n#{entity[1]} = B_SPLINE_SURFACE_WITH_KNOTS\(([^;]*);", text)
    poles = re.findall(r"#(\d+)", surface[1])
    point = re.search(rf"\n#{poles[len(poles) // 2 + 4]} = CARTESIAN_POINT\('',\(([^)]*)\)\)", text)
    x, y, z = (float(v) for v in point[1].replace("\n", "").split(","))
    moved = point[0].replace(point[1], f"{x},{y},{z + 0.1 * UM!r}")
    path = tmp_path / "moved.step"
    path.write_text(text.replace(point[0], moved))
    apart = face_deviations(upright, read_faces(path))
    # a pole in the middle of the net moves the face by a sixth of its own way
    assert apart["FF2"] > FACE_LIMIT
    assert apart["FF1"] < 1e-3 * FACE_LIMIT
    conformity = replace(built[1], face_deviation=apart)
    assert any(
        re.match(r"FF2 is 0\.\d+ µm from its design", words) for words in conformity.faults()
    )


def test_faces_lost_or_of_another_kind_are_infinitely_far(upright, built):
    faces = dict(read_faces(built[0] / "standard.step"))
    faces["FF1"], faces["SPH1"] = None, faces["FF2"]
    del faces["SPH3"]
    apart = face_deviations(upright, faces)
    assert [name for name, value in apart.items() if np.isinf(value)] == ["FF1", "SPH1", "SPH3"]


def test_part21_reader_refuses_what_is_no_step_file(tmp_path):
    path = tmp_path / "a.step"
    path.write_text("ISO-10303-21;\nnothing\n")
    with pytest.raises(BadFile, match="no entities"):
        read_faces(path)
    path.write_text("DATA;\n#1 = ADVANCED_FACE('FF1',(#2),#9,.T.);\n#2 = X('');\nENDSEC;")
    with pytest.raises(BadFile, match="a reference to #9"):
        read_faces(path)


def test_stl_is_closed_for_both_libraries_and_knows_its_faces(upright, built):
    place, conformity, mesh = built
    corners, triangles = read_stl(place / "standard.stl")
    assert len(triangles) == len(mesh.triangles) == conformity.triangles
    assert is_watertight(corners, triangles)
    assert manifold_volume(corners, triangles) == pytest.approx(
        mesh_volume(corners, triangles), rel=1e-6
    )
    # what the kernel knew and what the surfaces say agree
    found = owners(upright, corners, triangles)
    named = np.isin(
        mesh.owner, [*(p.name for p in upright.patches), *(s.name for s in upright.spheres)]
    )
    assert np.mean(found[named] == mesh.owner[named]) > 0.999
    assert set(found[~named]) == {""}


def test_a_mesh_with_a_triangle_missing_is_refused_by_both(built):
    corners, triangles = read_stl(built[0] / "standard.stl")
    assert not is_watertight(corners, triangles[1:])
    assert np.isnan(manifold_volume(corners, triangles[1:]))


def test_chord_error_of_a_triangle_on_a_sphere_is_its_sagitta(upright):
    # a regular triangle with its corners on a ball of radius r: its middle lies
    # r - sqrt(r^2 - s^2/3) below the ball
    sphere = upright.spheres[0]
    assert isinstance(sphere, DatumSphere)
    up = np.array([0.0, 0.0, 1.0])
    angle = 2.0 * np.pi * np.arange(3) / 3.0
    lean = 0.1
    corners = sphere.centre + sphere.radius * np.column_stack(
        [np.sin(lean) * np.cos(angle), np.sin(lean) * np.sin(angle), np.full(3, np.cos(lean))]
    )
    sagitta = sphere.radius * (1.0 - np.cos(lean))
    one = replace(upright, patches=upright.patches[:1], spheres=(sphere,))
    owner = np.array([sphere.name])
    errors = chord_errors(one, Mesh(corners, np.array([[0, 1, 2]]), owner))
    # the lattice of measured points has none exactly in the middle: a little less is found
    assert 0.85 * sagitta < errors[sphere.name] <= sagitta + NM
    assert up @ (corners.mean(axis=0) - sphere.centre) == pytest.approx(sphere.radius - sagitta)


@pytest.mark.slow
def test_same_standard_gives_the_same_bytes(upright, built, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONHASHSEED", "77")
    cad_out.verify.export_standard(upright, tmp_path, chord=0.02)
    for name in (*FILES, "standard-parts.step"):
        assert (tmp_path / name).read_bytes() == (built[0] / name).read_bytes()
    reported = json.loads((tmp_path / "conformity.json").read_text())
    assert reported["faults"] == []
    assert reported["measured"]["mass"] == built[1].mass
    assert reported["limits"]["face_deviation_mm"] == FACE_LIMIT


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"solids": 2}, "2 solids in the STEP file, expected 7"),
        ({"displaced": ("SPH1",)}, "not in its place: SPH1"),
        ({"misread": ("note 1",)}, "not in the STEP file as meant: note 1"),
        ({"sharp": 3.0}, "3.0 mm of inner edges without a radius of 3 mm"),
        ({"is_valid": False}, "not valid"),
        ({"is_closed": False}, "not closed"),
        ({"shells": 8}, "8 shells in 7 solids: closed pockets inside"),
        ({"is_millimetre": False}, "not in millimetres"),
        ({"missing": ("FF2",)}, "faces without their name: FF2"),
        ({"volume": 1.0}, "the volume changes"),
        ({"area_error": {"FF1": 0.02}}, "FF1 has 2.0e-02 more or less area"),
        ({"is_watertight": False}, "trimesh finds the STL file not watertight"),
        ({"manifold_volume": float("nan")}, "manifold3d does not agree"),
        ({"chord_error": {"SPH1": 0.05}}, "SPH1: mesh 50.0 µm off, limit 20 µm"),
    ],
)
def test_every_figure_out_of_its_limit_is_named(built, change, words):
    assert set(change) <= {f.name for f in fields(built[1])}
    assert any(words in fault for fault in replace(built[1], **change).faults())


def spoilt(upright, **what):
    patches = (replace(upright.patches[0], **what), *upright.patches[1:])
    return replace(upright, patches=patches)


def test_a_refused_design_leaves_the_files_of_the_last_one(upright, tmp_path, monkeypatch):
    kernel_here(monkeypatch)
    for name in ("standard.step", "standard.stl"):
        (tmp_path / name).write_text("of the last run")
    adrift = spoilt(upright, depth=8.0)
    with pytest.raises(
        NotBuildable, match=r"'small' falls into 2 solids .* does not reach the body"
    ):
        cad_out.verify.export_standard(adrift, tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["standard.step", "standard.stl"]
    assert (tmp_path / "standard.step").read_text() == "of the last run"


def test_a_crash_of_the_kernel_is_one_clear_error(upright, tmp_path, monkeypatch):
    def crashing(module, task, folder, *arguments, timeout):
        return run_apart("faulthandler", "_sigsegv() or print", folder, timeout=timeout)

    monkeypatch.setattr(process, "run_apart", crashing)
    with pytest.raises(
        NotBuildable, match=r"CAD kernel crashed \(SIGSEGV, exit code -11\).*nothing was written"
    ) as caught:
        cad_out.verify.export_standard(upright, tmp_path)
    assert "\n" not in str(caught.value)
    assert caught.value.facts["exit_code"] == -11
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_reported_with_the_folder(upright, tmp_path, monkeypatch):
    ending = Ending(1, "", "OSError: [Errno 28] No space left on device")
    monkeypatch.setattr(process, "run_apart", lambda *_, **__: ending)
    expected = rf"^{tmp_path}: cannot be written \(\[Errno 28\] No space left on device\)$"
    with pytest.raises(DesignError, match=expected):
        cad_out.verify.export_standard(upright, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_task_that_hangs_is_stopped(tmp_path):
    ending = run_apart("time", "sleep(30) or print", tmp_path, timeout=0.5)
    assert ending.code is None
    assert not ending.is_good
    assert str(ending) == "did not finish in time and was stopped"


def test_a_task_that_fails_shows_its_last_line(tmp_path):
    ending = run_apart("math", "sqrt(-1.0) or print", tmp_path)
    assert str(ending).startswith("failed (exit code 1): ValueError: ")


def test_what_a_task_refuses_comes_back_in_its_words(tmp_path, monkeypatch):
    ending = run_apart("matstd.twin.files", "read_machine", tmp_path)  # which is a folder
    assert str(ending) == ending.refusal
    assert str(tmp_path) in ending.refusal
    assert not ending.is_good
    monkeypatch.setattr(process, "run_apart", lambda *_, **__: ending)
    with pytest.raises(NotBuildable, match=re.escape(ending.refusal)):
        process.run_kernel("build", tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_random_standards_build_valid_solids(random_standard, tmp_path, seed):
    standard = random_standard(seed)
    conformity = cad_out.verify.export_standard(standard, tmp_path, chord=0.02)
    assert conformity.faults() == []
    details = details_of(standard)
    less = volume_by_hand.recesses(standard, details) + volume_by_hand.seats(standard, details)
    assert conformity.volume == pytest.approx(standard.volume(2.0) - less, rel=2e-3)
