"""STL files, binary and as text, against corners that are known."""

import numpy as np

from matstd.cad_out.meshes import Mesh, read_stl, write_stl

CORNERS = np.array([[0.0, 0.0, 0.0], [10.5, 0.0, 0.0], [0.0, 20.25, 0.0], [0.0, 0.0, -3.0]])
TRIANGLES = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])

TEXT = "".join(
    "facet normal 0 0 0\nouter loop\n"
    + "".join("vertex {:g} {:g} {:g}\n".format(*CORNERS[k]) for k in triangle)
    + "endloop\nendfacet\n"
    for triangle in TRIANGLES
)


def test_binary_and_text_give_the_same_corners_once(tmp_path):
    binary, text = tmp_path / "b.stl", tmp_path / "t.stl"
    write_stl(binary, Mesh(CORNERS, TRIANGLES, np.full(len(TRIANGLES), "")))
    text.write_text(f"solid a\n{TEXT}endsolid a\n")
    for path in (binary, text):
        corners, triangles = read_stl(path)
        assert len(corners) == 4
        np.testing.assert_array_equal(corners[triangles], CORNERS[TRIANGLES])
