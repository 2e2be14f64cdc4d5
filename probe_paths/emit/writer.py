"""The blocks of a plan's programs, in the order in which a cautious operator would have them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from probe_paths.language import (
    LENGTH_LIMIT,
    SYSTEM_INDEX,
    TOOL_LENGTH,
    Dialect,
    ErrorText,
    Label,
    Q,
    SharedMask,
)
from probe_paths.language import klartext as k
from probe_paths.plan import (
    LINEAR,
    Heading,
    ProgramFrame,
    TouchPlan,
    Visit,
    calibration_hash,
    home_readings,
    stated_serial,
    waypoints,
)
from twin.frames import Array, apply
from twin.record import IntArray
from twin.units import DEG, MINUTE

_LONGEST_TITLE = k.MAX_LINE - len("12345 * - ")
"""Characters of the title of a visit beside its block number and mark."""


@dataclass(frozen=True)
class Feeds:
    """Feeds as they stand in a program, mm/min and degrees/min, and where a file ends.

    Attributes:
        probing: Of cycle 4; the same at the calibration of the probe.
        approach: Along Z below the clearance height, and back from a touch.
        turning: Of the last motion towards a rotary position.
        touches_per_file: After so many touches the next visit begins a new file.
    """

    probing: float = 250.0
    approach: float = 2000.0
    turning: float = 1000.0
    touches_per_file: int = 400


class Writer:
    """Writes the text of one plan's programs."""

    def __init__(self, plan: TouchPlan, dialect: Dialect, feeds: Feeds) -> None:
        self.plan, self.dialect, self.feeds = plan, dialect, feeds
        self.frame = ProgramFrame(plan.chain, plan.probe)
        self.rotary = plan.chain.rotary_axes
        self.number = {name: i + 1 for i, name in enumerate(plan.standard.features)}
        self.heading = Heading(
            standard=plan.standard.name,
            setup=plan.setup,
            probe=plan.probe,
            workshop=plan.options.workshop,
            serial=stated_serial(plan.standard.serial),
            calibration=calibration_hash(plan.standard),
        )
        top = plan.chain.link("Z").range[1]
        self.retract = k.line({"Z": top - plan.options.retract}, words="M91")

    def text(self, name: str, title: str, part: list[int], duration: float) -> str:
        """Whole text of a program that makes the visits `part`."""
        out = k.Listing()
        rows = np.flatnonzero(np.isin(self.plan.visit, part))
        out.add(k.begin(name), k.comment(title), *self._remarks(rows, duration), *self._stock())
        self._reset(out)
        self._calibration(out, name)
        here = home_readings(self.plan.chain)
        for count, v in enumerate(part):
            visit = self.plan.visits[v]
            out.add(k.structure(visit_title(self.rotary, count + 1, len(part), visit)))
            self._turn(out, here, visit)
            self._touches(out, visit, np.flatnonzero(self.plan.visit == v))
            here = visit.rotary
        self._finish(out, name)
        self._subprograms(out, name)
        out.add(k.end(name))
        return out.text

    def _remarks(self, rows: IntArray, duration: float) -> list[str]:
        """What the operator must know, and what a reader of the text must."""
        probe = self.plan.probe
        table = f"L{k.signed(probe.tool_length)} R{k.signed(probe.radius)}"
        used = dict.fromkeys(self.plan.feature[rows].tolist())
        features = sorted(used, key=self.number.__getitem__)
        return [
            *(k.comment(text) for text in self.heading.lines),
            *(k.comment(f"FEATURE {self.number[f]} IS {f}") for f in features),
            k.comment(
                f"TOUCHES {rows[0] + 1} TO {rows[-1] + 1}, ABOUT {duration / MINUTE:.0f} MIN"
            ),
            k.comment(
                f"PRESET {self.dialect.preset}: TABLE CENTRE WITH ROTARY AXES AT ZERO, NO ROT"
            ),
            k.comment(f"TOOL {self.dialect.tool} IS THE PROBE: {table}, SPINDLE MUST NOT TURN"),
            k.comment("TABLE MUST BE FREE TO TURN WITH Z RETRACTED"),
        ]

    def _stock(self) -> list[str]:
        """Box round the standard at rotary zero, for the control's graphics."""
        x, y = self.plan.standard.base.half_size
        top = self.plan.standard.blank_height
        box = np.array([[a, b, c] for a in (-x, x) for b in (-y, y) for c in (0.0, top)])
        corners = apply(self.plan.setup.T_table_artefact, box)
        return k.stock(list(np.floor(corners.min(axis=0))), list(np.ceil(corners.max(axis=0))))

    def _reset(self, out: k.Listing) -> None:
        out.add(k.structure("RESET"), k.TCPM_OFF, k.PLANE_OFF, *k.datum_shift_off(), self.retract)
        out.add(k.tool_call(self.dialect.tool), k.preset(self.dialect.preset), self.retract)
        out.add(*self._home())

    def _home(self) -> list[str]:
        """Rotary axes to where every program begins and ends, the way that unwinds them."""
        home = home_readings(self.plan.chain)
        return [k.SHORTER_WAY_OFF, *([k.line(self._words(home))] if self.rotary else [])]

    def _words(self, rotary: Array) -> dict[str, float]:
        """Words of rotary readings (R,), in the order in which the control shows its axes."""
        words = {a: v / DEG for a, v in zip(self.rotary, rotary, strict=True)}
        return dict(sorted(words.items()))

    def _calibration(self, out: k.Listing, name: str) -> None:
        """Log of the probe's calibration, the tool and the preset."""
        out.add(
            k.structure("LOG THE PROBE"),
            k.WAIT,
            k.system_read(Q.PROBE_RADIUS, 350, 11),
            k.system_read(Q.PROBE_LENGTH, 350, 12),
            k.system_read(Q.OFFSET_X, 350, 14, 1),
            k.system_read(Q.OFFSET_Y, 350, 14, 2),
            k.system_read(Q.TOOL, 20, 1),
            k.assign(Q.PRESET, self.dialect.preset),
            k.difference(Q.LENGTH_OFF, TOOL_LENGTH, self.plan.probe.tool_length),
            k.jump_if_less(Q.LENGTH_OFF, -LENGTH_LIMIT, Label.OTHER_PROBE),
            k.jump_if_greater(Q.LENGTH_OFF, LENGTH_LIMIT, Label.OTHER_PROBE),
            self._print(f"{name}.A", name),
        )

    def _print(self, mask: str, name: str) -> str:
        control = self.dialect.on_control
        return k.print_masked(control(mask), control(f"{name}.TXT"))

    def _turn(self, out: k.Listing, here: Array, visit: Visit) -> None:
        """Retract, turn past the position, then to it from the stated side."""
        out.add(self.retract)
        if self.rotary:
            for place in waypoints(here, visit.before):
                out.add(k.line(self._words(place), words=k.SHORTER_WAY))
            out.add(k.line(self._words(visit.rotary), self.feeds.turning))
        out.add(k.assign(Q.POSE, visit.pose + 1))
        out.add(*(k.assign(q, s) for q, s in zip((Q.SIDE_1, Q.SIDE_2), visit.side, strict=False)))

    def _touches(self, out: k.Listing, visit: Visit, rows: IntArray) -> None:
        """All touches of a visit, each from the clearance height and back to it."""
        up = k.line({"Z": self.frame.coordinate("Z", visit.height)})
        options, feeds = self.plan.options, self.feeds
        for count, row in enumerate(rows):
            start = self.frame.coordinates(self.plan.start[row], LINEAR)
            feature = str(self.plan.feature[row])
            anchor = " (ANCHOR)" if self.plan.request[row] < 0 else ""
            out.add(
                k.comment(f"TOUCH {row + 1} ON {feature}{anchor}"),
                k.assign(Q.TOUCH, row + 1),
                k.assign(Q.FEATURE, self.number[feature]),
                k.assign(Q.STATUS, -1),
                k.line({a: start[a] for a in "XY"}),
                *([up] if count == 0 else []),
                k.line({"Z": start["Z"]}, feeds.approach),
                *k.probe_vector(
                    self.dialect.words,
                    Q.RESULT_X,
                    list(self.plan.direction[row]),
                    self.plan.distance,
                    feeds.probing,
                    options.standoff,
                ),
                k.call(Label.LOG),
                k.line(start, feeds.approach),
                up,
            )

    def _finish(self, out: k.Listing, name: str) -> None:
        out.add(k.structure("END"), self.retract, k.WAIT, self._print(f"{SharedMask.END}.A", name))
        out.add(*self._home(), k.PROGRAM_STOP)

    def _subprograms(self, out: k.Listing, name: str) -> None:
        """Look at the status and log; retract and stop where there was no contact."""
        places = zip((Q.ROTARY_1, Q.ROTARY_2), self.rotary, strict=False)
        out.add(
            k.label(Label.LOG, "CHECK AND LOG ONE TOUCH"),
            k.jump_if_less(Q.STATUS, 0, Label.NO_CONTACT),
            k.WAIT,
            *(k.system_read(q, 240, 1, SYSTEM_INDEX[a]) for q, a in places),
            self._print(f"{SharedMask.POINT}.A", name),
            k.LABEL_END,
            k.label(Label.NO_CONTACT, "NOTRIGGER: NO CONTACT"),
            k.RETRACT_MAX,
            k.WAIT,
            self._print(f"{SharedMask.NO_CONTACT}.A", name),
            k.OPERATOR_STOP,
            k.stop_with_error(ErrorText.TOUCH_POINT_INACCESSIBLE),
            k.label(Label.OTHER_PROBE, "NOT THE PROBE OF THE PLAN"),
            k.OPERATOR_STOP,
            k.stop_with_error(ErrorText.INPUT_VALUE_INCORRECT),
        )


def visit_title(rotary: Sequence[str], count: int, total: int, visit: Visit) -> str:
    """Which visit it is, where, and from which side its rotary readings are reached.

    Args:
        rotary: Names of the rotary axes.
        count: Number of the visit in its program, from 1.
        total: Number of visits of its program.
        visit: The visit.
    """
    words = [
        f"{a}{v / DEG:+.2f} FROM {'BELOW' if s > 0 else 'ABOVE'}"
        for a, v, s in sorted(zip(rotary, visit.rotary, visit.side, strict=True))
    ]
    title = " ".join([f"VISIT {count} OF {total}, POSE {visit.pose + 1}:", *words])
    if len(title) <= _LONGEST_TITLE:
        return title
    return title.replace(" FROM ", " ").replace(" OF ", "/").replace(", POSE", " POSE")
