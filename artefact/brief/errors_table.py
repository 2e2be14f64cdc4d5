"""`[errors]` of a project file: expected sizes, shapes and correlations of errors."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from matstd.sensitivity.population import (
    CLASSES,
    Dependence,
    Distributions,
    Group,
    Mix,
    Population,
    grouped,
)
from matstd.twin.errors import BadFile, BadValue, DesignError, UnknownSymbol
from matstd.twin.files import Pair, Table
from matstd.twin.machine import DEFAULT_RANGES, Chain, Ranges, ShapeName, error_class
from matstd.twin.units import UM, URAD, in_another_unit

LARGEST = 1e5
"""Largest amplitude, µm or µrad: a tenth of a radian, beyond which first order says little."""


class MixTable(Table):
    """`EXX = { shapes = ["linear", "sinusoidal"], weights = [2, 1], periods = [1, 2] }`."""

    shapes: list[ShapeName]
    """any of `constant`, `linear`, `parabolic`, `sinusoidal`, each once"""
    weights: list[float] = Field(default_factory=list)
    """relative probability of each. Default: equal"""
    periods: list[int] = Field(default_factory=lambda: [1])
    """numbers of periods of a sinusoidal error, drawn with equal probability"""


class GroupTable(Table):
    """`[[errors.groups]]`: errors of one cause."""

    names: list[str]
    """two errors or more; a minus before a name reverses its sign"""
    correlation: float = 1.0
    """correlation of every two amplitudes, 0 to 1"""
    same_shape: bool = False
    """whether shape, periods and phase are common too"""


class CorrelationTable(Table):
    """`[errors.correlation]`: a matrix over some errors."""

    names: list[str]
    """the errors"""
    matrix: list[list[float]]
    """their correlations, one row each"""


class ErrorsTable(Table):
    """`[errors]`: amplitude ranges by class and by parameter, µm or µrad, shapes and relations."""

    classes: dict[str, Pair] = Field(default_factory=dict)
    """smallest and largest peak amplitude of a class"""
    parameters: dict[str, Pair] = Field(default_factory=dict)
    """the same for single errors, `EXC = [5.0, 10.0]`; they take precedence over their class"""
    shapes: dict[str, MixTable] = Field(default_factory=dict)
    """shapes over the reading to draw from, for a class or an error"""
    groups: list[GroupTable] = Field(default_factory=list)
    """errors of one cause, `[[errors.groups]]`"""
    correlation: CorrelationTable | None = None
    """instead of groups: a correlation matrix of some errors, `[errors.correlation]`"""


def expected_errors(table: ErrorsTable, chain: Chain, path: Path) -> Population:
    """Population of machines that a table describes; raises BadFile with file and key."""
    ranges = _ranges(table, chain, path)
    if all(ranges.of(chain, symbol)[1] == 0.0 for symbol in chain.symbols):
        raise BadFile(path, "errors", "amplitudes of zero for every error", "one above zero")
    distributions = _distributions(table, chain, path)
    dependence = _dependence(table, path)
    try:
        return Population(chain, ranges, distributions, dependence)
    except DesignError as error:
        key = "errors.groups" if table.groups else "errors.correlation"
        raise BadFile(path, key, str(error), "what machines can have") from error


def _ranges(table: ErrorsTable, chain: Chain, path: Path) -> Ranges:
    """Amplitude ranges."""
    by_class = dict(DEFAULT_RANGES)
    for name, pair in table.classes.items():
        if name not in by_class:
            raise BadFile(
                path, f"errors.classes.{name}", "an unknown class", f"one of {', '.join(by_class)}"
            )
        is_zero = name in ("rotary_zero", "arm_zero")
        angular = name.split("_")[-1] in ("rotation", "tilt", "squareness") or is_zero
        by_class[name] = _amplitudes(pair, URAD if angular else UM, path, f"errors.classes.{name}")
    by_name = {}
    for name, pair in table.parameters.items():
        key = f"errors.parameters.{name}"
        unit = URAD if _known(name, chain, path, key).is_angular else UM
        by_name[name] = _amplitudes(pair, unit, path, key)
    return Ranges(by_class, by_name)


def _known(name: str, chain: Chain, path: Path, key: str) -> Any:
    """The error parameter of a name."""
    try:
        return chain.symbol(name)
    except UnknownSymbol as error:
        raise BadFile.of(path, error, key=key) from None


def _amplitudes(pair: Pair, unit: float, path: Path, key: str) -> tuple[float, float]:
    if not 0.0 <= pair[0] <= pair[1]:
        raise BadFile(path, key, list(pair), "amplitudes from zero up, the smaller first")
    if pair[1] > LARGEST:
        raise BadFile(path, key, list(pair), f"{LARGEST:g} at most, in µm or µrad")
    return pair[0] * unit, pair[1] * unit


def amplitude_slips(errors: Population, path: Path) -> Iterator[BadFile]:
    """Stated amplitudes that look typed in another unit; a very good machine may have them."""
    for symbol in errors.chain.symbols:
        key, stated = f"errors.parameters.{symbol.name}", errors.ranges.by_name.get(symbol.name)
        name = error_class(errors.chain, symbol)
        if stated is None:
            key, stated = f"errors.classes.{name}", errors.ranges.by_class[name]
        unit, word = (URAD, "µrad") if symbol.is_angular else (UM, "µm")
        pair = [end / unit for end in stated]
        other = in_another_unit(pair, word, DEFAULT_RANGES[name][1] / unit)
        if other is not None:
            meant = [round(other[1] * end, 6) for end in pair]
            yield BadFile(path, key, pair, f"{word}; is it in {other[0]}, {meant} {word}?")


def _distributions(table: ErrorsTable, chain: Chain, path: Path) -> Distributions:
    """Shapes by class and by name."""
    by_class, by_name = {}, {}
    for name, mix in table.shapes.items():
        key = f"errors.shapes.{name}"
        try:
            made = Mix(tuple(mix.shapes), tuple(mix.periods), tuple(mix.weights))
        except BadValue as error:
            raise BadFile.of(path, error, within=key) from error
        if name in CLASSES:
            by_class[name] = made
            continue
        if name in DEFAULT_RANGES:
            raise BadFile(path, key, "a class of constants", f"one of {', '.join(CLASSES)}")
        _known(name, chain, path, key)
        by_name[name] = made
    distributions = Distributions(by_class=by_class, by_name=by_name)
    try:
        distributions.check(chain)
    except DesignError as error:
        raise BadFile(
            path, "errors.shapes", str(error), "errors that vary with a reading"
        ) from None
    return distributions


def _dependence(table: ErrorsTable, path: Path) -> Dependence | None:
    """Relations between errors, from groups or from a matrix."""
    if table.groups and table.correlation:
        raise BadFile(path, "errors", "groups and a correlation matrix", "one of the two")
    try:
        if table.correlation:
            if any(len(row) != len(table.correlation.names) for row in table.correlation.matrix):
                raise DesignError("rows of another length than the names")
            return Dependence(tuple(table.correlation.names), np.array(table.correlation.matrix))
        if table.groups:
            return grouped(
                [Group(tuple(g.names), g.correlation, g.same_shape) for g in table.groups]
            )
    except DesignError as error:
        key = "errors.groups" if table.groups else "errors.correlation"
        raise BadFile(path, key, str(error), "what machines can have") from error
    return None
