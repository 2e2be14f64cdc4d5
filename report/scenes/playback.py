"""Playback of programs: a page that moves table and probe by the text of the programs.

The page stands alone: positions of every body between which it goes on evenly, and a few lines that
draw them. Poses come from the kinematics of the twin, so that the page knows no machine.
"""

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from matstd.probe_paths.control import Clock, Move, ProbeStep, ReadProgram, interpret, step_times
from matstd.probe_paths.emit import ProgramSet
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import TouchPlan
from matstd.report.scenes.bodies import TOOL, Drawn, drawn_bodies
from matstd.twin.files import write_whole
from matstd.twin.frames import Array, inverse
from matstd.twin.machine import Chain, table_to_tool
from matstd.twin.record import IntArray
from matstd.twin.units import DEG

PLAYBACK = "playback.html"
"""Name of the page."""

_STEP = 6.0 * DEG
"""Between two positions while something turns, rad: even steps between them are 0.15 % short."""

_GRAIN = 0.05
"""Of the corners of bodies, mm."""


def write_playback(page: Path, plan: TouchPlan, programs: ProgramSet, dialect: Dialect) -> None:
    """Write the page.

    Args:
        page: To be written.
        plan: What is set up, and with which probe.
        programs: As written; their text is read again, and nothing else is played.
        dialect: Of the control.
    """
    read = [
        interpret(
            p.text.encode("ascii"),
            Path(p.file),
            programs.masks.get,
            plan.chain,
            plan.probe,
            dialect,
        )
        for p in programs.programs
    ]
    bodies = drawn_bodies(plan)
    frames = key_frames(read, plan)
    carriers = list(dict.fromkeys(body.on for body in bodies))
    scene = {
        "time": _packed(frames.time, "<f4"),
        "line": _packed(frames.line, "<u4"),
        "touch": _packed(frames.touch, "<u4"),
        "program": _packed(frames.program, "<u1"),
        "names": [p.name for p in read],
        "features": [
            {t.number: p.features[t.feature] for t in p.touches if not t.is_air} for p in read
        ],
        "grain": _GRAIN,
        "carriers": [_carried(poses(plan.chain, frames.q, on)) for on in carriers],
        "bodies": [_body(body, carriers.index(body.on)) for body in bodies],
        "probe": carriers.index(TOOL),
    }
    environment = Environment(
        loader=PackageLoader("matstd.report.scenes"), autoescape=True, undefined=StrictUndefined
    )
    template = environment.get_template(PLAYBACK)
    write_whole(page, template.render(scene=scene, standard=plan.standard.name))


@dataclass(frozen=True, eq=False)
class KeyFrames:
    """Positions of a run of programs, between which everything moves evenly.

    Attributes:
        time: Since the start, s, (K,).
        q: Readings, (K, A).
        line: Of the program file, (K,).
        touch: Number of the touch that is being made; 0 for other moves, (K,).
        program: Which of them, (K,).
    """

    time: Array
    q: Array
    line: IntArray
    touch: IntArray
    program: IntArray


def key_frames(programs: Sequence[ReadProgram], plan: TouchPlan) -> KeyFrames:
    """Where everything stands at the end of every move, and often enough while something turns."""
    rows: list[tuple[float, Array, int, int, int]] = []
    begin, rotary = 0.0, [plan.chain.axis_index(a) for a in plan.chain.rotary_axes]
    for k, program in enumerate(programs):
        travel = np.array([t.distance if t.is_air else t.back for t in program.touches])
        times = begin + step_times(plan.chain, program.steps, Clock(), travel)
        for step, time in zip(program.steps, times, strict=True):
            if isinstance(step, Move):
                row = (float(time), np.nan_to_num(step.q), step.line, 0, k)
            elif isinstance(step, ProbeStep):
                end = np.nan_to_num(step.q) + travel[step.index] * step.direction
                row = (float(time), end, step.line, step.number, k)
            else:
                continue
            rows += _between(rows[-1], row, rotary) if rows else []
            rows.append(row)
        begin = float(times[-1])
    time, q, line, touch, index = zip(*rows, strict=True)
    return KeyFrames(
        time=np.array(time),
        q=np.array(q),
        line=np.array(line),
        touch=np.array(touch),
        program=np.array(index),
    )


def _between(
    before: tuple[float, Array, int, int, int],
    row: tuple[float, Array, int, int, int],
    rotary: list[int],
) -> list[tuple[float, Array, int, int, int]]:
    """Further positions of a turn."""
    (t, q, *_), (end, there, *what) = before, row
    pieces = int(np.ceil(np.abs(there - q)[rotary].max(initial=0.0) / _STEP))
    shares = np.linspace(0.0, 1.0, pieces + 1)[1:-1] if pieces > 1 else ()
    return [(t + s * (end - t), q + s * (there - q), what[0], what[1], what[2]) for s in shares]


def poses(chain: Chain, q: Array, on: str) -> Array:
    """Poses (K, 4, 4) of a carrier, seen from the table as it is with every axis at zero.

    Args:
        chain: The machine.
        q: Readings, (K, A).
        on: Axis that carries it, `TOOL`, or empty for the table.
    """
    inner = [k.name for k in chain.links if k.carries_workpiece and k.kind != "fixed"]
    still = q.copy()
    still[:, [chain.axis_index(a) for a in inner]] = 0.0
    T_home_tool = table_to_tool(chain, still)
    if on == TOOL:
        return T_home_tool
    carried = q.copy()
    below = inner[: inner.index(on)] if on else []
    carried[:, [chain.axis_index(a) for a in below]] = 0.0
    return T_home_tool @ inverse(table_to_tool(chain, carried))


def _packed(values: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")


def _carried(T: Array) -> dict[str, str]:
    """Rotations, every one once, which of them holds at each position, and the places."""
    turned = np.round(T[:, :3, :3].reshape(len(T), 9), 6)
    found, which = np.unique(turned, axis=0, return_inverse=True)
    return {
        "rotations": _packed(found, "<f4"),
        "which": _packed(which.reshape(-1), "<u2"),
        "places": _packed(T[:, :3, 3], "<f4"),
    }


def _body(body: Drawn, carrier: int) -> dict[str, str | int]:
    corners = np.round(body.corners.reshape(-1) / _GRAIN)
    return {"carrier": carrier, "colour": body.colour, "corners": _packed(corners, "<i2")}
