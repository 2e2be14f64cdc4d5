"""The page on which a machine moves: its data, its words, one file that loads nothing."""

from collections.abc import Sequence

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from matstd.report.layout import marked
from matstd.report.live import TREE, packed, scripted, style
from matstd.report.machine.chain_bodies import Letter, chain_bodies
from matstd.report.machine.error_series import ErrorFunction
from matstd.report.machine.machine_words import (
    ShownMachine,
    machine_lead,
    machine_meaning,
    machine_next,
    machine_notes,
)
from matstd.report.machine.played import Played
from matstd.report.machine.solids import Drawn
from matstd.twin.machine import Chain, Family, parse_symbol
from matstd.twin.units import UM

_LEAST_GRAIN = 0.05  # of the corners of bodies, mm
_REACH = 32_000  # steps of a corner's coordinate that fit into 16 bits
_DRAWN_AS = 25.0  # length as which the largest errors together are drawn at first, mm
_HELP = (
    "Drag the picture to turn it, with Shift to move it, wheel to zoom; or Tab to it and use the "
    "arrow keys, + and -."
)


def machine_html(shown: ShownMachine) -> str:
    """The page, one file that loads nothing."""
    plain, letters = chain_bodies(shown.chain, shown.length)
    bodies = [*(b for b in plain if b.on not in shown.replaced), *shown.bodies]
    environment = Environment(
        loader=PackageLoader("matstd.report.machine"), autoescape=True, undefined=StrictUndefined
    )
    chain = shown.chain
    return environment.get_template("machine.html").render(
        title=f"{chain.name} in motion",
        heading=chain.name,
        lead=machine_lead(shown),
        means=marked(machine_meaning(shown)),
        next=marked(machine_next(shown)),
        notes=machine_notes(shown),
        picture=f"{chain.name}, {chain.notation}, with its tool point",
        help=_HELP,
        has_program=shown.program is not None,
        style=style(),
        script=scripted("machine", _data(shown, bodies, letters)),
    )


def _data(shown: ShownMachine, bodies: Sequence[Drawn], letters: Sequence[Letter]) -> TREE:
    """Everything that the scripts need."""
    chain = shown.chain
    ranges = [chain.link(a).range for a in chain.axes]
    size = sum(one.size**2 for one in shown.errors) ** 0.5
    power = np.log10(_DRAWN_AS / size) if size > 0.0 else 3.0
    return {
        **machine_data(chain),
        "low": [*(low for low, _ in ranges), 0.0],
        "high": [*(high for _, high in ranges), shown.duration],
        "length": shown.length,
        "up": "y" if _is_level(chain) else "z",
        "exaggeration": float(10.0 ** np.clip(np.round(2.0 * power) / 2.0, 0.0, 4.0)),
        "bodies": [_body(body) for body in bodies],
        "letters": [{"on": k.on, "text": k.text, "place": list(k.place)} for k in letters],
        "errors": [_error(one) for one in shown.errors if not one.left_out],
        "is_assumed": shown.is_assumed,
        "program": None if shown.program is None else _program(shown.program.thinned()),
        "datum": None
        if shown.datum is None
        else {"q": shown.datum[0].tolist(), "length": shown.datum[1]},
    }


def machine_data(chain: Chain) -> TREE:
    """A chain, its axes and its error parameters, as the scripts take them."""
    return {
        "machine": _machine(chain),
        "axes": [
            {
                "name": a,
                "low": chain.link(a).range[0],
                "high": chain.link(a).range[1],
                "is_rotary": chain.link(a).kind == "rotary",
                "is_programmed": chain.link(a).programmed,
            }
            for a in chain.axes
        ],
        "symbols": _symbols(chain),
    }


def _machine(chain: Chain) -> TREE:
    """The chain as `parts/kinematics.js` has it."""
    return {
        "links": [
            {
                "name": k.name,
                "kind": k.kind,
                "carries": k.carries_workpiece,
                "direction": k.direction.tolist(),
                "point": k.point.tolist(),
                "axis": -1 if k.kind == "fixed" else chain.axis_index(k.name),
                "own": 0 if k.kind == "fixed" else k.own,
                **({} if k.is_along_letter else {"frame": k.frame.tolist()}),
            }
            for k in chain.links
        ],
        "origin": chain.table_origin.tolist(),
    }


def _is_level(chain: Chain) -> bool:
    """Whether the spindle is level and Y upright: the table turns about Y, and none about Z."""
    turned = [k for k in chain.links if k.carries_workpiece and k.kind == "rotary"]
    about = [int(np.argmax(np.abs(k.direction))) for k in turned]
    return about[:1] == [1] and 2 not in about


def _body(body: Drawn) -> TREE:
    reach = float(np.abs(body.corners).max(initial=0.0))
    grain = max(_LEAST_GRAIN, reach / _REACH)
    return {
        "on": body.on,
        "colour": body.colour,
        "corners": packed(body.corners.reshape(-1, 3), "i2", grain=grain, unit="mm"),
    }


def _error(one: ErrorFunction) -> TREE:
    symbol = parse_symbol(one.name)
    return {
        "name": one.name,
        "title": one.title or (symbol.title if symbol is not None else one.name),
        "words": [w for w in one.words if "(" not in w],
        "size": one.size / UM,
        "u": one.u / UM,
        "series": [
            {
                "part": s.part,
                "link": s.link,
                "component": s.component,
                "readings": list(s.readings),
                "side": None if s.side is None else list(s.side),
                "coefficients": packed(s.coefficients, "f8"),
            }
            for s in one.series
        ],
    }


def _symbols(chain: Chain) -> list[TREE]:
    """Every error parameter with its place in the chain."""
    return [
        {
            "name": s.name,
            "title": s.title,
            "axis": s.link,
            "part": "twist" if s.family is Family.COMPONENT else "place",
            "link": chain.link_index(s.link),
            "component": s.component,
        }
        for s in chain.symbols
    ]


def _program(played: Played) -> TREE:
    out: TREE = {
        "names": list(played.names),
        "texts": list(played.texts),
        "time": packed(played.time, "f8", unit="s"),
        "q": packed(played.q, "f4"),
        "sides": packed(played.sides, "i1"),
        "length": packed(played.length, "f4", unit="mm"),
        "line": packed(played.line, "u4"),
        "which": packed(played.which, "u2"),
    }
    if played.touch is not None:
        out["touch"] = packed(played.touch, "u4")
        out["features"] = [{str(k): v for k, v in one.items()} for one in played.features]
    if played.normal is not None:
        out["normal"] = packed(played.normal, "f4")
    if played.clearance is not None and played.nearest is not None:
        names, which = np.unique(played.nearest, return_inverse=True)
        out["clearance"] = packed(played.clearance, "f4", unit="mm")
        out["nearest"] = names.tolist()
        out["nearest_body"] = packed(which.reshape(-1), "u2")
    return out
