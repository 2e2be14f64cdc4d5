"""The assembly for printers and viewers: 3MF and binary glTF, the same bytes every time."""

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from matstd.cad_out.meshes.mesh import Mesh
from matstd.twin.frames import Array

_LONG_AGO = (1980, 1, 1, 0, 0, 0)  # the first time stamp that an archive can have
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
_RELATIONS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" \
Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""


@dataclass(frozen=True, eq=False)
class Piece:
    """Triangles of one product."""

    name: str
    mesh: Mesh  # in its own frame, mm
    colours: Array  # of every triangle, red, green, blue from 0 to 1, (F, 3)
    # name and place of every instance, mm
    places: tuple[tuple[str, tuple[float, float, float]], ...]


def write_3mf(path: Path, title: str, pieces: Sequence[Piece]) -> None:
    """3MF, core specification: an object a product, a coloured material a role."""
    table = np.unique(np.concatenate([piece.colours for piece in pieces]), axis=0)
    bases = "".join(
        f'<base name="{k}" displaycolor="#{_hex(rgb)}"/>' for k, rgb in enumerate(table, 1)
    )
    objects, items = [], []
    for number, piece in enumerate(pieces, 2):
        objects.append(_object(number, piece, table))
        for name, place in piece.places:
            move = " ".join(["1 0 0 0 1 0 0 0 1", *(repr(float(x)) for x in place)])
            name = quoteattr(name)
            items.append(f'<item objectid="{number}" transform="{move}" partnumber={name}/>')
    model = (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xmlns="{_CORE}">\n'
        f'<metadata name="Title">{quoteattr(title)[1:-1]}</metadata>\n'
        f'<resources><basematerials id="1">{bases}</basematerials>\n{"".join(objects)}'
        f"</resources>\n<build>{''.join(items)}</build></model>\n"
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name, text in (
            ("[Content_Types].xml", _TYPES),
            ("_rels/.rels", _RELATIONS),
            ("3D/3dmodel.model", model),
        ):
            # a fixed time stamp gives the same bytes every time
            entry = zipfile.ZipInfo(name, _LONG_AGO)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)


def _object(number: int, piece: Piece, table: Array) -> str:
    colour = (piece.colours[:, None] == table).all(axis=-1).argmax(axis=1)
    corners = _each('<vertex x="%.6f" y="%.6f" z="%.6f"/>', piece.mesh.corners)
    rows = np.column_stack([piece.mesh.triangles, colour])
    triangles = _each('<triangle v1="%d" v2="%d" v3="%d" pid="1" p1="%d"/>', rows)
    return (
        f'<object id="{number}" type="model" name={quoteattr(piece.name)} pid="1" '
        f'pindex="{colour[0]}"><mesh><vertices>{corners}</vertices>\n'
        f"<triangles>{triangles}</triangles></mesh></object>\n"
    )


def _each(form: str, rows: np.ndarray) -> str:
    """Rows of numbers, each in a form, all at once."""
    return (form * len(rows)) % tuple(rows.ravel().tolist())


def _hex(rgb: Array) -> str:
    return "".join(f"{round(255.0 * value):02X}" for value in rgb)


def write_glb(path: Path, pieces: Sequence[Piece]) -> None:
    """Binary glTF 2.0: metres, y upwards, a mesh a product and colour, a node an instance."""
    import trimesh

    scene = trimesh.Scene(base_frame="world")
    to_metres = np.diag([1e-3, 1e-3, 1e-3, 1.0])
    upright = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1.0]])
    for piece in pieces:
        for rgb in np.unique(piece.colours, axis=0):
            mine = piece.mesh.of((piece.colours == rgb).all(axis=1))
            # colours of glTF are linear, those of screens are not
            linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
            look = trimesh.visual.material.PBRMaterial(
                name=_hex(rgb),
                baseColorFactor=[*linear.tolist(), 1.0],
                metallicFactor=0.3,
                roughnessFactor=0.5,
            )
            shape = trimesh.Trimesh(mine.corners, mine.triangles, process=False)
            shape.visual = trimesh.visual.TextureVisuals(material=look)
            for name, place in piece.places:
                T = np.eye(4)
                T[:3, 3] = place
                scene.add_geometry(
                    shape,
                    node_name=f"{name} {look.name}",
                    geom_name=f"{piece.name} {look.name}",
                    transform=upright @ to_metres @ T,
                )
    path.write_bytes(scene.export(file_type="glb"))
