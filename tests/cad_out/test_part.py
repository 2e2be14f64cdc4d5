"""The standard goes on in build123d: same solid, named faces, and it can be cut."""

import pytest

from artefact.body.standard import Standard
from cad_out.build.part import as_part


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::SyntaxWarning")
def test_a_user_goes_on_with_the_part(upright: Standard) -> None:
    from build123d import Cylinder, Pos

    solid, faces = as_part(upright)
    assert solid.is_valid
    assert solid.label == upright.name
    assert {p.name for p in upright.patches} <= set(faces)
    # independent of the kernel: a voxel count of the signed distance, good to some per cent
    assert solid.volume == pytest.approx(upright.volume(), rel=0.03)
    height = upright.base.thickness
    x, y = upright.base.half_size[0] - 15.0, 0.0
    drilled = solid - Pos(x, y, 0.5 * height) * Cylinder(3.0, 2.0 * height)
    assert solid.volume - drilled.volume == pytest.approx(
        3.141592653589793 * 9.0 * height, rel=1e-6
    )
