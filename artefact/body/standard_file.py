"""Reader and writer of `standard.toml`, which holds a standard without loss."""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
from pydantic import Field

from matstd.artefact.body.datum import DatumSphere, MountingHole
from matstd.artefact.body.freeform import ErrorShare, FreeformPatch
from matstd.artefact.body.known import Known
from matstd.artefact.body.known_file import KnownTable, known_table
from matstd.artefact.body.material import Material
from matstd.artefact.body.sag import DIRECTIONS, Sag
from matstd.artefact.body.standard import Base, Core, Standard
from matstd.twin.errors import BadFile, ShapeMismatch
from matstd.twin.files import Table, checked, read_toml, write_whole
from matstd.twin.units import UM

FORMAT = "standard/1"

Positive = Annotated[float, Field(gt=0.0)]
Modulus = Annotated[float, Field(ge=1e3, le=1.2e6)]  # MPa, up to that of diamond
_LETTERS = "letters, digits and `_`, a letter first, 32 at most"
Name = Annotated[
    str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=32, description=_LETTERS)
]
Pair = Annotated[list[Positive], Field(min_length=2, max_length=2)]
Triple = Annotated[list[float], Field(min_length=3, max_length=3)]
Degree = Annotated[int, Field(ge=2, le=9)]

_OLD_SOURCE, _OLD_MODULUS = "finite elements", 200e3
"""For a sag without a modulus: earlier versions computed all of them for steel, N/mm^2."""

_UNIT = re.compile(r"_(mm|MPa|kg_mm3)$")  # at the end of a key
_Made = TypeVar("_Made", DatumSphere, MountingHole)

_ORTHONORMAL = 1e-9  # deviation of R R^T from 1 that counts as an error and not as rounding


class _Material(Table):
    name: str
    density_kg_mm3: Positive
    expansion: float = Field(alias="expansion_1_K", ge=0.0, lt=1e-3)
    u_expansion: float | None = Field(default=None, alias="expansion_u_1_K", ge=0.0, lt=1e-3)
    modulus_MPa: Modulus | None = None  # noqa: N815
    poisson: float = Field(default=0.3, gt=0.0, lt=0.5)
    modulus_source: str = "stated"
    modulus_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    hardness: str = ""


class _Base(Table):
    half_size_mm: Pair
    corner_radius_mm: Positive
    thickness_mm: Positive


class _Core(Table):
    low_radius_mm: Positive
    high_radius_mm: Positive
    height_mm: Positive


class _Error(Table):
    name: str
    share: Annotated[float, Field(ge=0.0, le=1.0)]


class _Patch(Table):
    name: Name
    origin_mm: Triple
    rotation: Annotated[list[Triple], Field(min_length=3, max_length=3)]
    half_size_mm: Pair
    depth_mm: Positive
    degree: Annotated[list[Degree], Field(min_length=2, max_length=2)]
    knots_u_mm: list[float]
    knots_v_mm: list[float]
    heights_mm: list[list[float]]
    errors: list[_Error] = Field(default_factory=list)


class _Sphere(Table):
    name: Name
    centre_mm: Triple
    radius_mm: Positive
    stem_radius_mm: Positive
    foot_radius_mm: Positive
    foot_mm: float
    proves: bool = False


class _Hole(Table):
    name: Name
    x_mm: float
    y_mm: float
    radius_mm: Positive
    bore_radius_mm: Positive
    bore_depth_mm: Positive


class _Sag(Table):
    source: str
    down: str = "-Z"
    share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.2
    modulus_MPa: Modulus | None = None  # noqa: N815
    um: dict[str, Annotated[list[Triple], Field(min_length=3, max_length=3)]]


class _File(Table):
    format: str
    name: str
    serial: str = ""
    blank_height_mm: Positive
    material: _Material
    base: _Base
    core: _Core | None = None
    patch: list[_Patch] = Field(default_factory=list)
    sphere: list[_Sphere] = Field(default_factory=list)
    hole: list[_Hole] = Field(default_factory=list)
    calibration: KnownTable | None = None
    sag: _Sag | None = None


def read_standard(path: str | Path) -> Standard:
    """Read `standard.toml`.

    Returns:
        The standard, in base units; bit for bit the one that was written.

    Raises:
        BadFile: Unreadable, not TOML, another format, a key missing, unknown or out of range.
    """
    return _standard(Path(path), checked(_File, read_toml(path, FORMAT), path))


def write_standard(path: str | Path, standard: Standard) -> None:
    """Write `standard.toml` whole or not at all; reading it returns the same numbers."""
    import tomli_w

    write_whole(path, tomli_w.dumps(_table(standard)))


def _standard(path: Path, file: _File) -> Standard:
    try:
        return Standard(
            name=file.name,
            serial=file.serial,
            material=Material(**_stated(file.material)),
            base=_base(path, file.base),
            core=None if file.core is None else Core(**_stated(file.core)),
            patches=tuple(_patch(path, i, patch) for i, patch in enumerate(file.patch)),
            spheres=tuple(
                _feature(DatumSphere, path, f"sphere.{i}", sphere, "a ball on a stem")
                for i, sphere in enumerate(file.sphere)
            ),
            holes=tuple(
                _feature(MountingHole, path, f"hole.{i}", hole, "a counterbored hole")
                for i, hole in enumerate(file.hole)
            ),
            blank_height=file.blank_height_mm,
            known=_known(path, file),
            sag=_sag(path, file),
        )
    except ShapeMismatch as error:
        raise BadFile(path, "names", str(error), "every feature with a name of its own") from error


def _known(path: Path, file: _File) -> Known | None:
    """The calibration, checked for features that exist."""
    if file.calibration is None:
        return None
    _check_features(path, file, "calibration.feature", file.calibration.feature)
    return file.calibration.known()


def _sag(path: Path, file: _File) -> Sag | None:
    """Displacements by weight, checked for features that exist."""
    if file.sag is None:
        return None
    _check_features(path, file, "sag.um", file.sag.um)
    if file.sag.down not in DIRECTIONS:
        raise BadFile(path, "sag.down", file.sag.down, f"one of {', '.join(DIRECTIONS)}")
    per_weight = {name: np.array(rows) * UM for name, rows in file.sag.um.items()}
    modulus = file.sag.modulus_MPa
    if modulus is None and file.sag.source == _OLD_SOURCE:
        modulus = _OLD_MODULUS
    return Sag(file.sag.source, file.sag.down, file.sag.share, per_weight, modulus=modulus)


def _check_features(path: Path, file: _File, key: str, named: Iterable[str]) -> None:
    """Reject figures of features that the standard does not have."""
    names = [patch.name for patch in file.patch] + [sphere.name for sphere in file.sphere]
    for name in named:
        if name not in names:
            raise BadFile(path, f"{key}.{name}", name, f"one of {', '.join(names)}")


def _base(path: Path, base: _Base) -> Base:
    if base.corner_radius_mm > min(base.half_size_mm):
        raise BadFile(
            path,
            "base.corner_radius_mm",
            base.corner_radius_mm,
            f"at most the smaller half side {min(base.half_size_mm):g}",
        )
    return Base(**_stated(base))


def _patch(path: Path, number: int, patch: _Patch) -> FreeformPatch:
    where = f"patch.{number}"
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = patch.rotation, patch.origin_mm
    slip = np.abs(T[:3, :3] @ T[:3, :3].T - np.eye(3)).max()
    if slip > _ORTHONORMAL or np.linalg.det(T[:3, :3]) < 0.0:
        raise BadFile(path, f"{where}.rotation", patch.rotation, "a right-handed rotation matrix")
    lengths = sorted({len(row) for row in patch.heights_mm})
    if len(lengths) != 1:
        raise BadFile(
            path, f"{where}.heights_mm", f"rows of {lengths} numbers", "rows of one length"
        )
    try:
        built = FreeformPatch(
            name=patch.name,
            T_artefact_patch=T,
            half_size=(patch.half_size_mm[0], patch.half_size_mm[1]),
            degree=(patch.degree[0], patch.degree[1]),
            knots_u=np.array(patch.knots_u_mm),
            knots_v=np.array(patch.knots_v_mm),
            heights=np.array(patch.heights_mm),
            depth=patch.depth_mm,
            errors=tuple(ErrorShare(e.name, e.share) for e in patch.errors),
        )
    except ShapeMismatch as error:
        raise BadFile(path, where, str(error), "knots and heights that belong together") from error
    return built


def _feature(made: type[_Made], path: Path, where: str, table: Table, expected: str) -> _Made:
    """A ball or a hole, whose sizes have to belong together."""
    try:
        return made(**_stated(table))
    except ShapeMismatch as error:
        raise BadFile(path, where, str(error), expected) from error


def _stated(table: Table) -> dict[str, Any]:
    """Values by the names that they have in a record: keys without their units."""
    values = {name: getattr(table, name) for name in type(table).model_fields}
    return {
        _UNIT.sub("", name): tuple(value) if isinstance(value, list) else value
        for name, value in values.items()
    }


def _written(record: Any, model: type[Table]) -> dict[str, Any]:
    """A record as the table that `_stated` reads; what is none, empty or false is left out."""
    out: dict[str, Any] = {}
    for name, field in model.model_fields.items():
        value = getattr(record, _UNIT.sub("", name))
        if isinstance(value, str | bool | None):
            out |= {field.alias or name: value} if value else {}
        else:
            out[field.alias or name] = _floats(value)
    return out


def _table(standard: Standard) -> dict[str, Any]:
    """The standard as the tables of the file."""
    base, core, material = standard.base, standard.core, standard.material
    table: dict[str, Any] = {
        "format": FORMAT,
        "name": standard.name,
        "serial": standard.serial,
        "blank_height_mm": float(standard.blank_height),
        "material": _written(material, _Material),
        "base": _written(base, _Base),
    }
    if material.modulus is None:
        for key in ("poisson", "modulus_source", "modulus_share"):
            table["material"].pop(key, None)
    if core is not None:
        table["core"] = _written(core, _Core)
    if standard.patches:
        table["patch"] = [_patch_table(patch) for patch in standard.patches]
    table["sphere"] = [_written(sphere, _Sphere) for sphere in standard.spheres]
    table["hole"] = [_written(hole, _Hole) for hole in standard.holes]
    if standard.known is not None:
        table["calibration"] = known_table(standard.known)
    if standard.sag is not None:
        table["sag"] = _sag_table(standard.sag)
    return table


def _sag_table(sag: Sag) -> dict[str, Any]:
    return {
        "source": sag.source,
        "down": sag.down,
        "share": float(sag.share),
        **({} if sag.modulus is None else {"modulus_MPa": float(sag.modulus)}),
        "um": {name: np.round(m / UM, 5).tolist() for name, m in sag.per_weight.items()},
    }


def _patch_table(patch: FreeformPatch) -> dict[str, Any]:
    return {
        "name": patch.name,
        "origin_mm": _floats(patch.T_artefact_patch[:3, 3]),
        "rotation": _floats(patch.T_artefact_patch[:3, :3]),
        "half_size_mm": _floats(patch.half_size),
        "depth_mm": float(patch.depth),
        "degree": [int(k) for k in patch.degree],
        "knots_u_mm": _floats(patch.knots_u),
        "knots_v_mm": _floats(patch.knots_v),
        "heights_mm": _floats(patch.heights),
        "errors": [{"name": e.name, "share": float(e.share)} for e in patch.errors],
    }


def _floats(values: Any) -> Any:
    """Nested lists of Python floats, which are written with their shortest exact digits."""
    return np.asarray(values, dtype=np.float64).tolist()
