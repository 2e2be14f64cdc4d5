"""The sensitivity page: 3-D scenes of the study, and the page without them."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from machines import LATHE

from matstd.cad_out.kernel.process import Ending
from matstd.report.maps.study_maps import _volumetric_sections
from matstd.report.pages import write_study_page
from matstd.report.pages.study_page import (
    ERROR_3D,
    S_3D,
    draw_study_volumes,
    error_scenes,
    sensitivity_scenes,
)
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.sensitivity.study import run_study
from matstd.twin.frames import apply
from matstd.twin.machine import tip
from matstd.twin.units import DEG, UM

NM = 1e-6  # mm


@pytest.fixture(scope="module")
def study(chain, workspace):
    return run_study(Population(chain), workspace, 100, 100, np.random.default_rng(5))


def test_error_scenes_show_level_and_worst_table_with_the_standard_in_its_place(study):
    T = np.eye(4)
    T[:3, 3] = [5.0, -6.0, 7.0]
    level, worst = error_scenes(study, T)
    assert level.title == "table level: B 0°, C 0°"
    assert worst.title.startswith("worst pose: B -")
    assert level.labels == ("X in mm", "Y in mm", "Z in mm")
    assert level.unit == "95 % quantile in µm"
    # normal errors have longer tails than bounded ones, by a few percent
    assert worst.values.max() == pytest.approx(study.volumetric.p95.max() / UM, rel=0.15)
    for scene, rotary in ((level, (0.0, 0.0)), (worst, None)):
        # readings at which the map shows a point of the standard do bring the tool point there
        q = study.worst_pose[None].copy()
        if rotary is not None:
            q[0, [study.chain.axis_index(a) for a in "BC"]] = rotary
        point = np.array([[10.0, 20.0, 30.0]])
        reading = apply(scene.T_readings_artefact, point)
        q[:, [study.chain.axis_index(a) for a in "XYZ"]] = reading
        np.testing.assert_allclose(tip(study.chain, q, 160.0), apply(T, point), atol=NM)


def test_scenes_of_S_are_of_different_links_and_change_in_the_volume(study):
    scenes = sensitivity_scenes(study)
    assert len(scenes) == 3
    names = [re.fullmatch(r"S of (\w+): B 0°, C 0°", s.title).group(1) for s in scenes]
    assert len({study.chain.symbol(n).link for n in names}) == 3
    for scene in scenes:
        assert scene.unit == "µm/µrad"
        assert np.ptp(scene.values) > 0.02 * scene.values.max()
        assert scene.values.max() < 1.0  # arms of less than a metre
        assert scene.T_readings_artefact is None


def test_without_opengl_the_page_is_written_with_a_remark(study, tmp_path, monkeypatch):
    failed = Ending(1, "", "libEGL warning")  # as in `test_scenes`, without OpenGL indeed
    monkeypatch.setattr("matstd.report.scenes.renderer.run_apart", lambda *_, **__: failed)
    (remark,) = write_study_page(study, tmp_path, [])
    assert "apt-get install libegl1" in remark
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "No maps in three dimensions" in page
    assert not (tmp_path / ERROR_3D).exists()
    assert not (tmp_path / S_3D).exists()


@pytest.mark.usefixtures("unrendered")
def test_a_machine_without_a_volume_is_reported_so(tmp_path):
    small = SimpleNamespace(workspace=Workspace(LATHE, {}, 50.0))
    remarks: list[str] = []
    assert draw_study_volumes(small, tmp_path, remarks) == []
    assert remarks == ["No maps in three dimensions: they need three linear axes that can move."]


def test_sections_of_the_workspace_have_its_readings_on_their_axes(study):
    """In degrees for a rotary axis, in mm for a linear one; the worst pose lies within."""
    drawn = _volumetric_sections(study)
    panels = [axes for axes in drawn.axes if axes.get_ylabel().partition(" ")[0] in tuple("XYZBC")]
    assert len(panels) == 2 * len(study.sections)
    for axes in panels:
        for label, shown in (
            (axes.get_xlabel(), axes.get_xlim()),
            (axes.get_ylabel(), axes.get_ylim()),
        ):
            unit = DEG if label[0] in "BC" else 1.0
            limits = study.workspace.limits[label[0]]
            np.testing.assert_allclose(shown, np.array(limits) / unit, rtol=1e-6)
