"""The body behind the touches of a run: the standard's file, a drawing, or the file beside it."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from demo import demo_standard
from made_up import made_up

from matstd.api.standards import probed_body
from matstd.artefact.body import DatumSphere, write_standard
from matstd.report.machine.meshes import MAX_TRIANGLES
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.frames import unit
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
    _, corners = probed_body(None, beside, run)
    corner = [*standard.base.half_size, standard.base.thickness]
    assert np.any(np.all(np.isclose(corners, corner), axis=-1))
    assert len(corners) <= MAX_TRIANGLES
    # stated by the user it is the same; of another standard nothing is guessed
    _, stated = probed_body(tmp_path / "standard.toml", run, run)
    assert np.array_equal(stated, corners)
    run = run_of("OTHER 001 0123456789AB")
    assert probed_body(None, beside, run)[1] is None
    with pytest.raises(DesignError, match=r"standard demo .*expected that of the run, OTHER 001"):
        probed_body(standard, run, run)


def test_a_drawing_of_many_triangles_is_thinned(tmp_path):
    run = run_of("")
    fine = trimesh.creation.uv_sphere(radius=40.0, count=(160, 160))
    assert len(fine.faces) > 50_000
    fine.export(tmp_path / "ball.stl")
    _, corners = probed_body(tmp_path / "ball.stl", run, run)
    assert len(corners) <= MAX_TRIANGLES
    away = np.linalg.norm(corners.reshape(-1, 3), axis=1)
    assert away == pytest.approx(40.0, abs=0.5)
    with pytest.raises(BadFile, match=r"expected one of \.stl"):
        probed_body(tmp_path / "ball.txt", run, run)


def on_features(standard, count):
    """Touches of a run without a stamp, each on the feature that it names."""
    rng, touches = np.random.default_rng(5), made_up("fork", count)
    names = np.array([(*standard.features,)[i % len(standard.features)] for i in range(count)])
    points = np.zeros((count, 3))
    for row, name in enumerate(names):
        surface = standard.features[name]
        if isinstance(surface, DatumSphere):  # by hand: a ball about its centre
            way = unit(rng.normal(size=(1, 3)))[0]
            points[row] = surface.centre + surface.radius * way
        else:
            points[row] = surface.point(rng.uniform(-5.0, 5.0, (1, 2)))[0]
    return replace(touches, feature=names, point=points)


def test_a_run_without_a_stamp_is_compared_with_the_standard(tmp_path, standard):
    """On its features it is taken with a remark; a mm off them, or with another name, it is not."""
    path, touches = tmp_path / "standard.toml", on_features(standard, 40)

    def probed(changed):
        return probed_body(path, "run.csv", Run(changed, np.zeros(40), np.ones(40)))

    run, corners = probed(touches)
    assert len(corners) > 0
    (said,) = run.remarks
    assert f"has no stamp, so nothing ties it to standard {standard.stamp}" in said
    assert "its 40 touches lie on the features" in said
    stamped, _ = probed_body(path, "run.csv", replace(run, standard=standard.stamp, remarks=()))
    assert stamped.remarks == ()
    off = touches.point.copy()
    off[7] += [0.0, 0.0, 60.0]
    with pytest.raises(DesignError, match=r"standard\.toml: 1 of 40 touches lie off standard"):
        probed(replace(touches, point=off))
    unnamed = np.full(40, "")
    assert probed(replace(touches, feature=unnamed))[0].remarks
    with pytest.raises(DesignError, match=r"1 of 40 touches lie off .* all features"):
        probed(replace(touches, point=off, feature=unnamed))
    with pytest.raises(DesignError, match="feature 'FF99' is not on standard"):
        probed(replace(touches, feature=np.where(np.arange(40) == 3, "FF99", touches.feature)))
