"""The standard as a build123d part, for further design: fixtures, engraving, drawings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matstd.artefact.body import Standard

if TYPE_CHECKING:
    import build123d


def as_part(standard: Standard) -> tuple[build123d.Solid, dict[str, build123d.Face]]:
    """The standard's body, labelled with its name, and its named faces as objects of build123d.

    The solid is the body that `export_standard` writes. It is built in this process, where a crash
    of the CAD kernel ends the caller.

    Raises:
        NotBuildable: The kernel's result is not one valid solid.

    Example:
        ``solid, faces = as_part(standard); stamped = solid - extrude(Text("001", 8), 0.5)``
    """
    from build123d import Face, Solid

    from matstd.cad_out.details import details_of
    from matstd.cad_out.kernel.solid import build_solid

    built = build_solid(standard, details_of(standard))
    solid = Solid(built.shape)
    solid.label = standard.name
    faces = {name: Face(face) for name, face in built.faces.items()}
    for name, face in faces.items():
        face.label = name
    return solid, faces
