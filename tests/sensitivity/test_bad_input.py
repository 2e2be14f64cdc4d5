"""Amplitudes of zero and workspaces without a pose: a clear line, or an empty but whole study."""

import numpy as np
import pytest

from matstd.report.maps import study_maps
from matstd.report.style import nothing as nothing_to_draw
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.sensitivity.study import run_study, write_study
from matstd.twin.errors import NotReachable
from matstd.twin.machine import DEFAULT_RANGES, Ranges


@pytest.mark.filterwarnings("error")
def test_a_machine_without_errors_gives_a_whole_study(
    chain, workspace, tmp_path, monkeypatch, rendered_alone
):
    """The two pictures of S, which know nothing of the sizes of errors, are left out."""
    rendered_alone("volumetric_sections", "variance_shares")
    for name in ("overview", "maps_of_S"):
        monkeypatch.setattr(study_maps, name, lambda _: nothing_to_draw("S"))
    nothing = Population(chain, Ranges({name: (0.0, 0.0) for name in DEFAULT_RANGES}, {}))
    study = run_study(nothing, workspace, 20, 50, np.random.default_rng(1))
    assert study.volumetric.mean.max() == study.shares.max() == study.rms.max() == 0.0
    assert study.tail == (0.0, 0.0)
    write_study(study, tmp_path, "sampled")
    written = study_maps.draw_maps(study, tmp_path)
    assert written
    assert all((tmp_path / name).stat().st_size > 0 for name, _ in written)


def test_no_reachable_pose_is_said(chain):
    far = Workspace(chain, {}, 160.0, ((5000.0, 5000.0, 5000.0), (5100.0, 5100.0, 5100.0)))
    with pytest.raises(NotReachable, match=r"only 0 of 800 poses have their tool point in"):
        run_study(Population(chain), far, 20, 50, np.random.default_rng(1))
