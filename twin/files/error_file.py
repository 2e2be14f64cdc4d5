"""Error file (TOML, format "errors/1"): the errors of one machine, as distributions by name."""

import math
from pathlib import Path
from typing import Literal

from pydantic import Field

from matstd.twin.effects import ComponentError, LocationError
from matstd.twin.errors import BadFile, UnknownSymbol
from matstd.twin.files.keys import Table, checked
from matstd.twin.files.slips import refuse_unit_slips
from matstd.twin.files.toml import read_toml
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Family, Symbol
from matstd.twin.model import Effect
from matstd.twin.units import DEG, UM, URAD, in_another_unit

LARGEST_ERROR = 1e6
"""An amplitude beyond this (µm or µrad: a metre, a radian) is a slip of units, not an error."""
USUAL_LARGEST = 30.0
"""Usual size of the largest error of lengths, µm: 0.0075 to 0.12 are asked about: in mm?"""


class ErrorTable(Table):
    """One error in one shape; a location error has an amplitude alone."""

    shape: Literal["constant", "linear", "parabolic", "sinusoidal"] | None = Field(
        default=None, examples=["linear"]
    )
    """`constant`, `linear`, `parabolic` or `sinusoidal`, for a component error; a location error
    has none"""
    amplitude: float = Field(ge=-LARGEST_ERROR, le=LARGEST_ERROR, examples=[12.0])
    """peak amplitude, µm, or µrad for `EA.` `EB.` `EC.`"""
    periods: float = Field(default=1.0, gt=0.0, le=1e6)
    """number of periods of a sinusoidal error: over the range of a linear axis, in one turn of a
    rotary axis"""
    phase_deg: float = 0.0
    """phase of a sinusoidal error"""


class ErrorFile(Table):
    """Keys of the file beside its errors."""

    format: str = Field(examples=["errors/1"])
    """kind and version of the file, `"errors/1"`"""
    confirmed: list[str] = Field(default_factory=list, examples=[["EXX.amplitude"]])
    """the largest amplitude where it looks like one in mm and is meant; it is not asked about"""


def read_errors(path: str | Path, chain: Chain) -> list[tuple[Effect, Array]]:
    """Errors of a machine as effects with their amplitudes (base units).

    Raises:
        BadFile: Unknown name or key, a shape missing or too many, a number that is none, or
            amplitudes in mm unless confirmed.
    """
    import numpy as np

    twice = "[[{name}]] in every place: the shapes of one error add up"
    data = read_toml(path, "errors/1", twice)
    beside = {key: data.pop(key) for key in ErrorFile.model_fields if key in data}
    head = checked(ErrorFile, beside, path)
    out: list[tuple[Effect, Array]] = []
    largest = (0.0, "")
    for name, tables in data.items():
        try:
            symbol = chain.symbol(name)
        except UnknownSymbol as error:
            raise BadFile.of(path, error) from None
        several = isinstance(tables, list) and bool(tables)  # an empty list is no error at all
        for i, table in enumerate(tables if several else [tables]):
            key = f"{name}[{i}]" if several else name
            entry = checked(ErrorTable, table, path, key)
            unit = URAD if symbol.is_angular else UM
            out.append((_effect(symbol, entry, path, key), np.array([entry.amplitude * unit])))
            if not symbol.is_angular:
                largest = max(largest, (abs(entry.amplitude), f"{key}.amplitude"))
    questions, word, (size, key) = list[BadFile](), "µm", largest
    if (slip := in_another_unit([size], word, USUAL_LARGEST)) and slip[0] == "mm":
        expected = f"{word}, the largest usually about {USUAL_LARGEST:g}; is it in {slip[0]}?"
        questions.append(BadFile(path, key, f"{size:g}", expected))
    refuse_unit_slips(head, path, questions, head.confirmed)
    return out


def _effect(symbol: Symbol, entry: ErrorTable, path: str | Path, key: str) -> Effect:
    """Effect of one entry."""
    if symbol.family is not Family.COMPONENT:
        if entry.shape not in (None, "constant") or entry.periods != 1.0 or entry.phase_deg:
            raise BadFile(path, key, f"shape {entry.shape!r}", "an amplitude alone: a constant")
        return LocationError(symbol)
    if entry.shape is None:
        raise BadFile(path, f"{key}.shape", "nothing", "constant, linear, parabolic or sinusoidal")
    if entry.shape != "sinusoidal" and (entry.periods != 1.0 or entry.phase_deg != 0.0):
        raise BadFile(path, key, "periods or phase_deg", 'them only with shape = "sinusoidal"')
    return ComponentError(symbol, entry.shape, entry.periods, entry.phase_deg * DEG)


def errors_toml(errors: list[tuple[Effect, Array]]) -> str:
    """Text of an error file for component and location errors, the inverse of `read_errors`."""
    tables: dict[str, list[str]] = {}
    for effect, theta in errors:
        assert isinstance(effect, ComponentError | LocationError), effect
        unit = URAD if effect.symbol.is_angular else UM
        lines = [f"amplitude = {float(theta[0]) / unit!r}"]
        if isinstance(effect, ComponentError):
            lines.insert(0, f'shape = "{effect.shape}"')
            if effect.shape == "sinusoidal":
                lines += [
                    f"periods = {float(effect.periods)!r}",
                    f"phase_deg = {math.degrees(effect.phase)!r}",
                ]
        tables.setdefault(effect.symbol.name, []).append("\n".join(lines))
    text = 'format = "errors/1"\n'
    for name, entries in tables.items():
        head = f"[{name}]" if len(entries) == 1 else f"[[{name}]]"
        text += "".join(f"\n{head}\n{entry}\n" for entry in entries)
    return text
