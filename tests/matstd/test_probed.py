"""The body behind the touches of a run: the standard's file, a drawing, or the file beside it."""

import numpy as np
import pytest
import trimesh
from demo import demo_standard
from made_up import made_up

from matstd.api.standards import probed_body
from matstd.artefact.body import write_standard
from matstd.report.machine.meshes import MAX_TRIANGLES
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.record import Run


def run_of(stamp):
    """Any run of a standard."""
    touches = made_up("fork", 20)
    return Run(touches, np.zeros(20), np.ones(20), standard=stamp)


@pytest.fixture
def standard(tmp_path):
    """The file of a standard: an upright base of 300 mm with ten faces, no higher than 200 mm."""
    known = demo_standard()
    write_standard(tmp_path / "standard.toml", known)
    return known


def test_the_standard_beside_its_run_is_drawn_and_no_other(tmp_path, standard):
    beside, run = str(tmp_path / "run.csv"), run_of(standard.stamp)
    corners = probed_body(None, beside, run)
    corner = [*standard.base.half_size, standard.base.thickness]
    assert np.any(np.all(np.isclose(corners, corner), axis=-1))
    assert len(corners) <= MAX_TRIANGLES
    # stated by the user it is the same; of another standard nothing is guessed
    stated = probed_body(tmp_path / "standard.toml", run, run)
    assert np.array_equal(stated, corners)
    run = run_of("OTHER 001 0123456789AB")
    assert probed_body(None, beside, run) is None
    with pytest.raises(DesignError, match=r"standard demo .*expected that of the run, OTHER 001"):
        probed_body(standard, run, run)


def test_a_drawing_of_many_triangles_is_thinned(tmp_path):
    run = run_of("")
    fine = trimesh.creation.uv_sphere(radius=40.0, count=(160, 160))
    assert len(fine.faces) > 50_000
    fine.export(tmp_path / "ball.stl")
    corners = probed_body(tmp_path / "ball.stl", run, run)
    assert len(corners) <= MAX_TRIANGLES
    away = np.linalg.norm(corners.reshape(-1, 3), axis=1)
    assert away == pytest.approx(40.0, abs=0.5)
    with pytest.raises(BadFile, match=r"expected one of \.stl"):
        probed_body(tmp_path / "ball.txt", run, run)
