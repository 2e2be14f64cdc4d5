"""The standard goes on in build123d: same solid, named faces, and it can be cut."""

import pytest
import volume_by_hand

from matstd.artefact.body.standard import Standard
from matstd.cad_out.details.detail_list import details_of
from matstd.cad_out.kernel.part import as_part


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::SyntaxWarning")
def test_a_user_goes_on_with_the_part(upright: Standard) -> None:
    from build123d import Cylinder, Pos

    solid, faces = as_part(upright)
    assert solid.is_valid
    assert solid.label == upright.name
    assert {p.name for p in upright.patches} <= set(faces)
    balls = sum(4.0 / 3.0 * 3.141592653589793 * s.radius**3 for s in upright.spheres)
    by_hand = volume_by_hand.of_upright(upright, details_of(upright))
    assert solid.volume == pytest.approx(by_hand - balls, rel=2e-5)
    height = upright.base.thickness
    x, y = upright.base.half_size[0] - 15.0, 0.0
    drilled = solid - Pos(x, y, 0.5 * height) * Cylinder(3.0, 2.0 * height)
    assert solid.volume - drilled.volume == pytest.approx(
        3.141592653589793 * 9.0 * (height - 1.0), rel=1e-6
    )
