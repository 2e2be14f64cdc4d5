"""Machines by themselves: what their errors do at poses, and how sensitive the tool point is."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import TextIO

import numpy as np
from pydantic_core import to_json

from matstd.twin import files as twin_files
from matstd.twin.compute import Progress, blocks, silent
from matstd.twin.display import Tabular
from matstd.twin.errors import BadArgument
from matstd.twin.files import read_errors, read_poses, written_whole
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, Model
from matstd.twin.record import at_poses
from matstd.twin.units import UM, URAD
from matstd.twin.words import did_you_mean

BLOCK = 10_000  # rows of a table that are computed at once: a second or two, some hundred MB
ERRORS = "-errors"  # ending of the name of a machine's error file

Poses = str | Path | tuple[Array, Array]
"""The path of a pose file, or readings (N, A), mm and rad, with tool lengths (N,), mm."""


def machine_names() -> list[str]:
    """Names of the machines that come with the tool.

    Example:
        >>> machine_names()
        ['afm-r1000', 'fork', 'hmc1995', 'hsm600u']
    """
    folder = files("matstd").joinpath("machines")
    stems = [path.name.removesuffix(".toml") for path in folder.iterdir()]
    return sorted(stem for stem in stems if not stem.endswith(ERRORS))


def machine_file(name: str, errors: bool = False) -> Path:
    """Machine file, or error file, of a machine that comes with the tool.

    Raises:
        BadArgument: No such machine, with those that are.

    Example:
        >>> machine_file("hsm600u").name, machine_file("hsm600u", errors=True).name
        ('hsm600u.toml', 'hsm600u-errors.toml')
    """
    names = machine_names()
    if name not in names:
        raise BadArgument("machine", name, f"one of {', '.join(names)}{did_you_mean(name, names)}")
    return Path(str(files("matstd").joinpath("machines", f"{name}{ERRORS if errors else ''}.toml")))


def read_machine(path: str | Path) -> Chain:
    """A machine from a machine file (docs/formats/machines.md).

    Raises:
        BadFile: File, key, what stood there, what was expected.

    Example:
        >>> chain = read_machine(machine_file("hsm600u"))
        >>> chain.linear_axes, chain.rotary_axes
        (('X', 'Y', 'Z'), ('C', 'B'))
    """
    return twin_files.read_machine(path)


def chain_of(machine: Chain | str | Path) -> Chain:
    """A machine, read where a path is given."""
    return machine if isinstance(machine, Chain) else read_machine(machine)


@dataclass(frozen=True, eq=False, repr=False)
class ToolPointDeviations(Tabular):
    """Deviations of the tool point in the table frame; `volumetric` returns them."""

    deviation: Array  # actual minus nominal, (N, 3), mm

    number_format = ".9f"

    def columns(self) -> dict[str, Array]:
        """One row per pose."""
        return dict(zip(("dx_um", "dy_um", "dz_um"), self.deviation.T / UM, strict=True))

    @cached_property
    def size(self) -> Array:
        """Length of every deviation, (N,), mm."""
        return np.sqrt(np.einsum("ni,ni->n", self.deviation, self.deviation))

    def save(self, path: str | Path, progress: Progress = silent) -> None:
        """Write the table as CSV, whole or not at all."""
        with _table(path, list(self.columns())) as out:
            for part in _blocks("table", len(self.deviation), progress):
                # rows are lists of JSON without brackets: its writer takes half the time of %.9f
                rows = to_json((self.deviation[part] / UM).round(9).tolist())
                out.write(rows[2:-2].replace(b"],[", b"\n").decode() + "\n")


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivities(Tabular):
    """Sensitivity of the tool point to every error parameter; `sensitivities` returns it."""

    names: tuple[str, ...]  # parameters, by their symbols of ISO 230-1
    S: Array  # size of the deviation per unit of each, (N, P), µm/µm, or µm/µrad of an angular one

    number_format = ".9g"

    def columns(self) -> dict[str, Array]:
        """One row per pose."""
        return dict(zip(self.names, self.S.T, strict=True))

    def save(self, path: str | Path) -> None:
        """Write the table as CSV, whole or not at all."""
        row = ",".join(["%.9g"] * len(self.names)) + "\n"
        with _table(path, self.names) as out:
            for values in self.S:
                out.write(row % tuple(values.tolist()))


def volumetric(
    machine: Chain | str | Path,
    errors: Sequence[tuple[Effect, Array]] | str | Path,
    poses: Poses,
    progress: Progress = silent,
) -> ToolPointDeviations:
    """Exact deviation of the tool point in the table frame at every pose.

    Args:
        machine: A machine, or the path of its file.
        errors: Effects with their parameters, or the path of an error file.
        poses: Readings and tool lengths, or the path of a pose file.
        progress: Called with what is being done.

    Raises:
        BadFile: A file that cannot be read.

    Example:
        >>> machine, errors = machine_file("hmc1995"), machine_file("hmc1995", errors=True)
        >>> ends = np.array([[-375.0, 0.0, 0.0, 0.0], [375.0, 0.0, 0.0, 0.0]])  # X, Z, Y, C1
        >>> found = volumetric(machine, errors, (ends, np.zeros(2)))
        >>> float(np.ptp(found.deviation[:, 0]).round(3))  # in 750 mm of X
        0.09
    """
    chain = chain_of(machine)
    known = read_errors(errors, chain) if isinstance(errors, str | Path) else errors
    model = Model(chain, tuple(effect for effect, _ in known))
    theta = np.concatenate([amplitude for _, amplitude in known] or [np.zeros(0)])

    def deviation(q: Array, length: Array) -> Array:
        touches = at_poses(chain, q, length)
        return model.tip(touches, theta) - touches.point  # which is the nominal tip

    return ToolPointDeviations(_over_blocks(deviation, chain, poses, 3, progress))


def sensitivities(
    machine: Chain | str | Path, poses: Poses, progress: Progress = silent
) -> Sensitivities:
    """Size of the deviation of the tool point per unit of every error parameter, first order.

    Args:
        machine: A machine, or the path of its file.
        poses: Readings and tool lengths, or the path of a pose file.
        progress: Called with what is being done.

    Raises:
        BadFile: A file that cannot be read.

    Example:
        >>> pose = np.zeros((1, 6)), np.array([160.0])
        >>> found = sensitivities(machine_file("hsm600u"), pose)
        >>> float(found.columns()["EXX"][0])
        1.0
    """
    from matstd.sensitivity.first_order import (
        sensitivity,  # half a second that others need not wait
    )

    chain = chain_of(machine)
    unit = np.array([URAD / UM if symbol.is_angular else 1.0 for symbol in chain.symbols])

    def sizes(q: Array, length: Array) -> Array:
        return sensitivity(chain, q, length) * unit

    S = _over_blocks(sizes, chain, poses, len(unit), progress)
    return Sensitivities(tuple(symbol.name for symbol in chain.symbols), S)


def _over_blocks(
    at: Callable[[Array, Array], Array], chain: Chain, poses: Poses, width: int, progress: Progress
) -> Array:
    """Rows of a table, (N, width), a block of poses at a time to bound the memory."""
    q, length = poses if isinstance(poses, tuple) else read_poses(poses, chain)
    out = np.empty((len(q), width))
    for part in _blocks("poses", len(q), progress):
        out[part] = at(q[part], length[part])
    return out


def _blocks(stage: str, rows: int, progress: Progress) -> Iterator[slice]:
    """Rows of a table, some at a time; the progress of a longer one is shown."""
    for block in blocks(rows, BLOCK):
        if block.start:
            progress(stage, block.start, rows)
        yield block


@contextmanager
def _table(path: str | Path, names: Sequence[str]) -> Iterator[TextIO]:
    """A CSV file with its line of names, written whole or not at all."""
    with written_whole(path) as part, open(part, "w", encoding="utf-8", newline="\n") as out:
        out.write(",".join(names) + "\n")
        yield out
