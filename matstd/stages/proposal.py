"""A first project for a machine: blank, probe, faces, place and workspace from travels and table.

What is proposed passes the checks with which a design begins (seat, reach, room); the largest base
that does is taken, up to `USUAL`.
"""

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np

from matstd.artefact.brief import (
    Brief,
    base_of,
    design_machine,
    probe_models,
    project_text,
    read_project,
)
from matstd.artefact.feasibility import Feasibility, check_seat, feasibility, stands
from matstd.artefact.reach import TABLE, Solid
from matstd.artefact.seat import base_corners, over_edge
from matstd.twin.compute import Progress, silent
from matstd.twin.errors import BadFile, DesignError, NotBuildable, NotReachable
from matstd.twin.frames import fixed_xyz
from matstd.twin.machine import Chain, linear_motion, tip
from matstd.twin.record import Setup
from matstd.twin.units import DEG

USUAL, LARGEST, LEAST = 320.0, 400.0, 160.0
"""Sides of a base, mm: the largest that is proposed unasked (24 kg), the largest that the gain is
stated of, and the smallest there is."""

SIZE_STEP = 20.0  # between two bases that are tried, mm

HEIGHT, LEAST_HEIGHT = 220.0, 120.0
"""Height of a standard, mm, of a base of 280 and more, and the smallest there is."""

HEIGHT_OVER_BASE = 0.8  # height over base of smaller ones

LENGTHS = (160.0, 100.0, 220.0)
"""Lengths of probes that are tried, mm: the usual one, one for small machines, one for deep."""

FACES = {280.0: 6, 240.0: 5, 200.0: 4, 0.0: 3}
"""Number of faces by the side of the base from which on it has room for them."""

SHARE_OF_TRAVEL = 0.8
"""Size of a table over the shorter travel across the tool, where no size is stated."""

TABLE_OVER_TRAVEL = 4.0
"""Table over a travel across the tool from which on that may be one in centimetres; the nine kinds
have 0.6 to 1.2, lathes with a short Y up to 4."""

WORKSPACE_OVER_BASE = 1.25
"""Workspace over base: workpieces are a quarter larger than what is probed."""

UPRIGHT, ON_ITS_SIDE = (0.0, 0.0, 0.0), (-90.0, 0.0, 0.0)
"""Ways to stand that are tried: on a face that looks along Z, or along Y; degrees."""

STEP_OF_PLACE, MOST_PLACES = 10.0, 3
"""Between two places of a second set-up, mm, and how many are tried with the reach of the machine
(half a second of processor each)."""

_GRID = 200  # points a side by which areas are counted: to 1 %
NEARLY_WHOLE = 1e-6  # by which a travel may miss a whole millimetre or degree


@dataclass(frozen=True)
class Proposal:
    """A project that passes the first checks of a design."""

    text: str  # of the project file
    brief: Brief  # the same, resolved
    table: tuple[float, ...]  # sides of the table, or its diameter, mm
    is_assumed: bool  # whether the size of the table was derived from the travels
    # side of the largest base that passes the same checks, mm; None where none larger than this one
    # does
    larger: float | None
    # farthest place of a second set-up along x of the table that passes them, mm; 0 where there is
    # none
    other_place: float

    @property
    def base(self) -> float:
        """Side of the base, mm."""
        return 2.0 * float(self.brief.blank.base.half_size[0])

    def share_of_table(self, base: float) -> float:
        """Share of the face of the table under a base in its middle."""
        a, b = self.table[0], self.table[-1]
        x, y = np.meshgrid(*((np.arange(_GRID) + 0.5) / _GRID - 0.5 for _ in "xy"))
        on = np.hypot(x, y) <= 0.5 if len(self.table) == 1 else np.full(x.shape, True)
        under = (np.abs(x) * a <= 0.5 * base) & (np.abs(y) * b <= 0.5 * base)
        return float((on & under).sum() / on.sum())


def propose(
    machine: Path, named: str, table: tuple[float, ...] | None = None, progress: Progress = silent
) -> Proposal:
    """The largest standard up to the usual one that a machine can be probed on.

    Args:
        machine: Machine file.
        named: Its path as the project file has it.
        table: Diameter of the table, or its two sides, mm; None derives it from the travels.

    Raises:
        DesignError: A machine on which no standard can be probed, and what binds.
    """
    chain = design_machine(machine)
    size = table or (_assumed_table(chain),)
    if not _bases(size, USUAL):
        corners = np.abs(base_corners(base_of((LEAST, LEAST)), np.eye(4))[:, :2])
        needed = f", which needs a round table of {2.0 * np.hypot(*corners.T).max():.0f} mm"
        raise DesignError(
            f"{machine}: a table of {min(size):g} mm: the smallest standard is "
            f"{LEAST:g} x {LEAST:g} x {LEAST_HEIGHT:g} mm{needed if len(size) == 1 else ''}; this "
            f"machine is too small for the tool{_in_centimetres(chain, size)}"
        )
    # from the usual size down; the first refusal is reported, since it binds what is wanted most
    first: DesignError | None = None
    trials = list(product(_bases(size, USUAL), LENGTHS, _turns(chain)))
    for i, (base, length, turn) in enumerate(trials):
        progress(f"seat, reach and room of a base of {base:g} mm", i, len(trials))
        made = _tables(chain, base, length, turn, size, machine)
        try:
            brief = _checked(made, machine)
        except (NotReachable, NotBuildable, BadFile) as error:
            first = first or error
            continue
        progress("what a larger base or another place covers", i, len(trials))
        larger = [side for side in _bases(size, LARGEST) if side > max(base, USUAL)]
        tried = (_tables(chain, side, length, turn, size, machine) for side in larger)
        fits = (side for side, t in zip(larger, tried, strict=True) if _is_reached(t, machine))
        text = _head(named) + project_text({**made, "": {**made[""], "machine": named}})
        return Proposal(
            text=text,
            brief=brief,
            table=size,
            is_assumed=table is None,
            larger=next(fits, None),
            other_place=_other_place(brief, 0.5 * (size[0] - base)),
        )
    unit = _in_centimetres(chain, size)
    raise DesignError(
        f"{machine}: no standard from {LEAST:g} mm up can be probed here: {first}{unit}"
    )


def _in_centimetres(chain: Chain, table: tuple[float, ...]) -> str:
    """The question whether the table, or a travel across the tool, is stated in centimetres."""
    if 5.0 * max(table) < _assumed_table(chain):
        return ", or is the table stated in cm?"
    small = small_travels(chain, table)
    return f", or is the travel of {' and '.join(small)} stated in cm?" if small else ""


def small_travels(chain: Chain, table: tuple[float, ...]) -> list[str]:
    """Axes across the tool whose travel is less than a `1 / TABLE_OVER_TRAVEL` of the table."""
    across = [a for a in chain.linear_axes if a[0] != "Z"]
    return [a for a in across if TABLE_OVER_TRAVEL * np.ptp(chain.link(a).range) < min(table)]


def _turns(chain: Chain) -> tuple[tuple[float, ...], ...]:
    """Ways to stand, that on the face square to the axis of a rotary table first."""
    tables = [chain.link(name) for name in chain.carrying_axes[:1]]
    is_across = any(t.kind == "rotary" and abs(t.direction[1]) > 0.7 for t in tables)
    return (ON_ITS_SIDE, UPRIGHT) if is_across else (UPRIGHT, ON_ITS_SIDE)


def _head(machine: str) -> str:
    return (
        f"# A design project for {machine}.   matstd design THIS.toml -o OUT\n"
        "# All keys with their defaults: docs/formats/project.md\n"
    )


def _assumed_table(chain: Chain) -> float:
    """Diameter of a table that suits the travels across the tool, mm, in tens."""
    widths = [np.ptp(chain.link(a).range) for a in chain.linear_axes if a[0] != "Z"]
    return float(np.floor(SHARE_OF_TRAVEL * min(widths, default=0.0) / 10.0) * 10.0)


def _bases(table: tuple[float, ...], most: float) -> list[float]:
    """Sides of bases that stand on a table with their corners, the largest first, mm."""
    face = Solid(TABLE, (0.5 * table[0], 0.5 * table[-1]), len(table) == 1, low=-1.0)
    sides = np.arange(most, LEAST - 1.0, -SIZE_STEP).tolist()
    return [side for side in sides if over_edge(face, base_of((side, side)), np.eye(4)) <= 0.0]


def _checked(tables: Mapping[str, Mapping[str, object]], machine: Path) -> Brief:
    """The project, resolved and past the first checks; raises the refusal."""
    brief = _read(tables, machine)
    check_seat(brief)
    feasibility(brief).check()
    return brief


def _read(tables: Mapping[str, Mapping[str, object]], machine: Path) -> Brief:
    """The project, resolved."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "project.toml"
        path.write_text(project_text(tables), encoding="utf-8")
        return replace(read_project(path), path=Path("project.toml"), machine_path=machine)


def _is_reached(tables: Mapping[str, Mapping[str, object]], machine: Path) -> bool:
    """Whether a project passes seat and reach.

    Alternatives that are only mentioned need no design: a larger base has more room for the faces.
    """
    try:
        brief = _read(tables, machine)
        check_seat(brief)
        _reach_alone(brief).check()
    except (NotReachable, NotBuildable, BadFile):
        return False
    return True


def _reach_alone(brief: Brief) -> Feasibility:
    """Whether enough of the blank is reached, whatever room the faces have."""
    return feasibility(replace(brief, options=replace(brief.options, family="balls")))


def _other_place(brief: Brief, beside: float) -> float:
    """Farthest place along x of the table, up to one beside the edge, mm; 0 for none.

    The seat binds as a rule, so every centimetre is tried with it, and few with the reach. A
    further set-up touches what the first one placed: it needs no room of its own.
    """
    places = np.arange(np.floor(beside / STEP_OF_PLACE) * STEP_OF_PLACE, 0.0, -STEP_OF_PLACE)
    seats = [place for place in places if stands(brief, _moved(brief, place))]
    for place in seats[:: max(1, len(seats) // MOST_PLACES)]:
        there = replace(brief, setups=(_moved(brief, place),))
        if _reach_alone(there).refusal is None:
            return float(place)
    return 0.0


def _moved(brief: Brief, along: float) -> Setup:
    T = brief.setup.T_table_artefact.copy()
    T[0, 3] += along
    return replace(brief.setup, T_table_artefact=T)


def _tables(
    chain: Chain,
    base: float,
    length: float,
    turn: tuple[float, ...],
    table: tuple[float, ...],
    machine: Path,
) -> dict[str, dict[str, object]]:
    """Keys of a project by table."""
    height = max(LEAST_HEIGHT, min(HEIGHT, HEIGHT_OVER_BASE * base // 10.0 * 10.0))
    sides = [float(side) for side in table]
    outline: dict[str, object] = {"diameter_mm": sides[0]}
    if len(table) > 1:
        outline = {"sides_mm": sides}
    nose = probe_models()["plain"].nose_diameter_mm
    faces = next(count for side, count in FACES.items() if base >= side)
    return {
        "": {"format": "project/1", "machine": machine.resolve().as_posix(), "seed": 1},
        "probe": {"radius_mm": 3.0, "length_mm": length, "nose_diameter_mm": nose},
        "workspace": dict(workspace(chain, base, height, length, turn)),
        "standard": {"name": "FFS-1", "patches": faces} | _down(turn),
        "blank": {"base_mm": [base, base], "height_mm": height},
        "setup.a": {"origin_mm": [0.0, 0.0, 0.0], "rotation_deg": list(turn)},
        "workshop.table": outline,
        "simulation": {"noise_um": 1.0, "machines": 3},
    }


def _down(turn: tuple[float, ...]) -> dict[str, object]:
    """Direction of weight: of a standard on a face along Y, the spindle is horizontal."""
    return {} if not any(turn) else {"down": "-Y"}


def _one_turn(low: float, high: float) -> tuple[float, float]:
    """A travel, or of a longer one a full turn, about zero where there is one, rad."""
    end = min(max(low, -np.pi) + 2.0 * np.pi, high)
    return max(low, end - 2.0 * np.pi), end


def workspace(
    chain: Chain, base: float, height: float, length: float, turn: tuple[float, ...]
) -> Iterator[tuple[str, list[float]]]:
    """Readings by axis at which the tool point is in a box over the seat, within the travels.

    The box is `WORKSPACE_OVER_BASE` times as wide as the base. Linear readings follow from the tool
    point, which they shift by their directions: a linear equation at every table pose.

    Args:
        turn: Rotation of the standard about x, y, z of the table, degrees.
    """
    half = 0.5 * WORKSPACE_OVER_BASE * base
    corners = np.array(list(product((-half, half), (-half, half), (0.0, height))))
    corners = corners @ fixed_xyz(np.array(turn) * DEG).T
    rotary = chain.rotary_axes
    ends = {a: _one_turn(*chain.link(a).range) for a in rotary}
    poses = list(product(*(np.linspace(ends[a][0], ends[a][1], 7) for a in rotary)))
    q = np.zeros((len(poses) * len(corners), len(chain.axes)))
    q[:, [chain.axis_index(a) for a in rotary]] = np.repeat(poses, len(corners), axis=0)
    points = np.tile(corners, (len(poses), 1))
    found = linear_motion(chain, q, points - tip(chain, q, length))
    for name in chain.programmed_axes:
        low, high = chain.link(name).range
        if name in rotary:
            low, high = (end / DEG for end in ends[name])
        else:
            inside = np.clip(found[:, chain.axis_index(name)], low, high)
            low, high = inside.min(), inside.max()
        # + 0.0: no minus before a zero in the file
        yield (
            name,
            [float(np.ceil(low - NEARLY_WHOLE)) + 0.0, float(np.floor(high + NEARLY_WHOLE)) + 0.0],
        )
