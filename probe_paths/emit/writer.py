"""The blocks of a plan's programs, in the order that a cautious operator would choose."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.probe_paths.language import (
    LANGUAGES,
    MAX_LINE,
    TOOL_LENGTH,
    Datum,
    Dialect,
    ErrorText,
    Interlock,
    Label,
    Q,
    SharedMask,
    Touch,
    interlocks,
    parse_mask,
    turn_tests,
)
from matstd.probe_paths.plan import (
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
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, IntArray, apply
from matstd.twin.units import DEG, MINUTE

_LONGEST_TITLE = MAX_LINE - len("12345 * - ")
"""Characters of the title of a visit beside its block number and mark."""


@dataclass(frozen=True)
class Feeds:
    """Feeds as they stand in a program, mm/min and degrees/min, and where a file ends."""

    probing: float = 250.0  # feed of cycle 4; the same at the calibration of the probe
    approach: float = 2000.0  # along Z below the clearance height, and back from a touch
    turning: float = 1000.0  # feed of the last motion towards a rotary position
    touches_per_file: int = 400  # after so many touches the next visit begins a new file
    minutes_per_file: float = np.inf  # a file takes no longer, unless one visit does


@dataclass(frozen=True)
class Purpose:
    """What a program is for."""

    ending: str = ""  # last letters of its name; empty for programs that measure
    remarks: tuple[str, ...] = ()
    # by how much a dry run is raised, which goes where the programs go and touches nothing, mm;
    # None for a program that touches
    raised: float | None = None
    is_first: bool = False  # it is written by `first`: one touch in the air and one on a ball


class Writer:
    """Writes the text of one plan's programs."""

    def __init__(
        self,
        plan: TouchPlan,
        dialect: Dialect,
        feeds: Feeds,
        masks: Mapping[str, str],
        purpose: Purpose,
    ) -> None:
        self.plan, self.dialect, self.feeds, self.masks = plan, dialect, feeds, masks
        self.purpose, self.raised = purpose, purpose.raised
        self.language = LANGUAGES[dialect.language]
        is_first = purpose.is_first
        # the commissioning program touches at home only, where no plane is tilted
        tilted = dialect.is_tilted and not is_first
        self.tilting = self.language.tilting if tilted and dialect.has_planes else None
        if tilted and self.tilting is None:
            raise DesignError("coordinates of tilted planes: the control has no PLANE SPATIAL")
        self.frame = plan.frame
        self.rotary = plan.chain.rotary_axes
        self.tests = interlocks(self.language, self.frame)
        self.number = {name: i + 1 for i, name in enumerate(plan.standard.features)}
        own = plan.standard
        if plan.options.ball is not None:  # which is not part of its calibration
            own = replace(own, spheres=own.spheres[:-1])
        self.heading = Heading(
            standard=plan.standard.name,
            setup=plan.setup,
            probe=plan.probe,
            workshop=plan.options.workshop,
            serial=stated_serial(plan.standard.serial),
            calibration=calibration_hash(own),
            arrangement=plan.chain.arrangement,
            ball=plan.options.ball,
            is_tilted=self.tilting is not None,
            sensors=() if is_first else dialect.sensors,
        )
        self.retract = self.language.retract(plan.top)
        # the tool change leaves a head anywhere: the first turn is one to watch
        self.first_feed = self.feeds.turning if plan.chain.tool_rotary_axes else None

    def text(self, name: str, title: str, part: list[int], duration: float) -> str:
        """Whole text of a program that makes the visits `part`."""
        k, rows = self.language, np.flatnonzero(np.isin(self.plan.visit, part))
        head = [k.begin(name), k.comment(title), *self._remarks(rows, duration), *self._stock()]
        main = [*self._reset(len(part)), *self._calibration(name)]
        here = home_readings(self.plan.chain)
        for count, v in enumerate(part):
            visit = self.plan.visits[v]
            main.append(k.structure(visit_title(self.rotary, count + 1, len(part), visit)))
            main += self._turn(here, visit)
            touches = self._touches(visit, np.flatnonzero(self.plan.visit == v))
            behind = Label.behind(count)
            if behind is not None:
                skip = k.skip_if_greater(Q.START, count + 1, behind)
                touches = [skip, *touches, k.skipped(behind)]
            main += touches
            here = visit.rotary
        main += self._finish(name)
        called = self._subprograms(name)
        body = [*called, *main] if k.subprograms_first else [*main, *called]
        return k.listed([*head, *body, k.end(name)])

    def _remarks(self, rows: IntArray, duration: float) -> list[str]:
        """Facts for the operator and for the reader of the text."""
        k = self.language
        used = dict.fromkeys(self.plan.feature[rows].tolist())
        features = sorted(used, key=self.number.__getitem__)
        return [
            *(k.comment(text) for text in self.heading.lines),
            *(k.comment(f"FEATURE {self.number[f]} IS {f}") for f in features),
            k.comment(
                f"TOUCHES {rows[0] + 1} TO {rows[-1] + 1}, ABOUT {duration / MINUTE:.0f} MIN"
                if self.raised is None
                else f"DRY RUN, RAISED BY {self.raised:+.1f} MM, NO TOUCH"
            ),
            *(k.comment(text) for text in (*self.purpose.remarks, *self._tool_remarks())),
            *([k.comment("ROTARY AXES MUST BE FREE TO TURN WITH Z RETRACTED")] * bool(self.rotary)),
            *(k.comment(text) for text in self._head_remarks()),
        ]

    def _head_remarks(self) -> list[str]:
        """Where a head turns and what its tool sweeps there, in machine coordinates."""
        turns = self.plan.head_turns
        if turns is None:
            return []
        (x, y, z), (to_x, to_y, _) = np.floor(turns.planned[0]), np.ceil(turns.planned[1])
        at = " ".join(f"{a}{v:+.0f}" for a, v in zip("XY", turns.place, strict=False))
        return [
            f"THE HEAD TURNS ONLY AT {at} OF THE MACHINE, Z RETRACTED",
            f"ITS TOOL SWEEPS X{x:+.0f} TO{to_x:+.0f} Y{y:+.0f} TO{to_y:+.0f} FROM Z{z:+.0f}",
        ]

    def _tool_remarks(self) -> list[str]:
        """Preset and tool that the operator must provide."""
        probe, dialect = self.plan.probe, self.dialect
        table = f"L{probe.tool_length:+.4f} R{probe.radius:+.4f}"
        at_zero = " WITH ROTARY AXES AT ZERO" * bool(self.rotary)
        return [
            f"PRESET {dialect.preset}: TABLE CENTRE{at_zero}, NO ROT",
            f"TOOL {dialect.tool} IS THE PROBE: {table}, SPINDLE MUST NOT TURN",
        ]

    def _stock(self) -> list[str]:
        """Box round the standard at rotary zero, for the control's graphics."""
        x, y = self.plan.standard.base.half_size
        top = self.plan.standard.blank_height
        box = np.array([[a, b, c] for a in (-x, x) for b in (-y, y) for c in (0.0, top)])
        corners = apply(self.plan.setup.T_table_artefact, box)
        return self.language.stock(
            list(np.floor(corners.min(axis=0))), list(np.ceil(corners.max(axis=0)))
        )

    def _reset(self, visits: int) -> list[str]:
        k, dialect = self.language, self.dialect
        start = [k.comment(f"START AT VISIT 1 TO {visits}:"), k.assign(Q.START, 1)]
        at_rest = self._all_tested(test for test in self.tests if test.is_at_rest)
        reset = [k.structure("RESET"), *k.reset(self.plan.chain, dialect), *at_rest, self.retract]
        return [*start, *reset, *self._called(), *self._home(self.first_feed)]

    def _called(self) -> list[str]:
        """Call of the probe, in the orientation of its calibration where the dialect has one."""
        k, dialect = self.language, self.dialect
        oriented = k.orientation if dialect.is_oriented else ()
        return [k.tool_call(dialect.tool), *oriented, k.preset(dialect.preset), self.retract]

    def _home(self, feed: float | None = None) -> list[str]:
        """Rotary axes to the position where programs begin and end, unwinding them.

        Args:
            feed: degrees/min; None is rapid.
        """
        k, home = self.language, home_readings(self.plan.chain)
        turned = [*k.unwind, *self._turning_place(), k.line(self._words(home), feed)]
        return turned if self.rotary else []

    def _turning_place(self) -> list[str]:
        """Where a head turns; a table may turn wherever X and Y stand."""
        turns = self.plan.head_turns
        return [] if turns is None else [self.language.to_turning_place(*turns.place[:2].tolist())]

    def _words(self, rotary: Array) -> dict[str, float]:
        """Words of rotary readings (R,), in the order in which the control shows its axes."""
        words = {a: v / DEG for a, v in zip(self.rotary, rotary, strict=True)}
        return dict(sorted(words.items()))

    def _calibration(self, name: str) -> list[str]:
        """Log of the probe's calibration, the tool and the preset."""
        k, printed = self.language, self._print(f"{name}.A", name)
        log = [k.structure("LOG THE PROBE"), *self._probe_data(), printed]
        return [
            *(log if self.raised is None else []),
            k.structure("TEST PROBE, PRESET AND MACHINE"),
            *([] if self.raised is None else [k.wait]),
            *self._all_tested(test for test in self.tests if not test.is_at_rest),
        ]

    def _probe_data(self) -> list[str]:
        """Read the calibration of the probe and the tool; note the preset."""
        k = self.language
        return [
            k.wait,
            k.read(Q.PROBE_RADIUS, Datum.RADIUS),
            k.read(Q.PROBE_LENGTH, Datum.LENGTH),
            k.read(Q.OFFSET_X, Datum.OFFSET_X),
            k.read(Q.OFFSET_Y, Datum.OFFSET_Y),
            k.read(Q.TOOL, Datum.TOOL),
            k.assign(Q.PRESET, self.dialect.preset),
        ]

    def _all_tested(self, tests: Iterable[Interlock]) -> list[str]:
        return [block for test in tests for block in self._tested(test)]

    def _tested(self, test: Interlock) -> list[str]:
        """Read, subtract the planned value, and stop where the rest exceeds its limit."""
        k = self.language
        if test.datum is None:
            rest = [k.difference(Q.CHECK, TOOL_LENGTH, test.planned)]
        else:
            rest = [k.read(Q.CHECK, test.datum)]
            if test.work is not None:
                rest += [k.read(Q.CHECK_WORK, test.work), k.minus(Q.CHECK, Q.CHECK_WORK)]
            rest += [k.difference(Q.CHECK, Q.CHECK, test.planned)] if test.planned else []
        return [
            *rest,
            k.jump_if_less(Q.CHECK, -test.limit, test.label),
            k.jump_if_greater(Q.CHECK, test.limit, test.label),
        ]

    def _alarms(self) -> list[str]:
        """Stops for failed tests; the number of the label is that of the alarm."""
        k = self.language
        alarms = {test.label: test.what for test in reversed(self.tests)}
        if self.rotary and k.tests_turns:
            alarms[Label.TURNED] = "a rotary axis is not where it was sent"
        return [
            block
            for label, what in sorted(alarms.items())
            for block in (
                k.label(label, f"ALARM {label:d}: {what.upper()}"),
                k.operator_stop,
                k.stop_with_error(ErrorText.INPUT_VALUE_INCORRECT),
            )
        ]

    def _print(self, mask: str, name: str) -> str:
        control = self.dialect.on_control
        lines = parse_mask(self.masks[mask], mask)
        return self.language.printed(control(mask), lines, control(f"{name}.TXT"))

    def _turn(self, here: Array, visit: Visit) -> list[str]:
        """Retract, turn past the position, and approach it from the stated side."""
        k, out = self.language, [self.retract, *self._end_plane()]
        if self.rotary:
            out += self._turning_place()
            out += [k.turn(self._words(place)) for place in waypoints(here, visit.before)]
            out.append(k.line(self._words(visit.rotary), self.feeds.turning))
            out += self._turn_checks(visit.rotary) if k.tests_turns else []
        out += self._plane(visit)
        sides = zip((Q.SIDE_1, Q.SIDE_2), visit.side, strict=False)
        return [*out, k.assign(Q.POSE, visit.pose + 1), *(k.assign(q, s) for q, s in sides)]

    def _turn_checks(self, rotary: Array) -> list[str]:
        """Tests that the rotary axes have reached their programmed position."""
        words = self._words(rotary)
        tests = turn_tests(self.language, self.frame)
        planned = (test._replace(planned=words[str(test.datum)]) for test in tests)
        return [self.language.wait, *self._all_tested(planned)]

    def _end_plane(self) -> list[str]:
        """End of a tilted plane, before the table turns."""
        return [self.tilting.off] if self.tilting else []

    def _plane(self, visit: Visit) -> list[str]:
        """The plane square to the tool, where coordinates are those of planes."""
        if self.tilting is None:
            return []
        master = float(visit.rotary[-1]) / DEG if self.rotary else 0.0
        return [self.tilting.on(list(self.frame.plane(visit.rotary)), master)]

    def _touches(self, visit: Visit, rows: IntArray) -> list[str]:
        """All touches of a visit, each from the clearance height and back to it."""
        k, options, feeds, top = self.language, self.plan.options, self.feeds, self.plan.top
        frame = self.frame.tilted(visit.rotary) if self.tilting else self.frame
        if self.raised is not None:
            return self._dry(visit, rows, frame)
        up, out = k.line({"Z": frame.height(visit.height, top)}, None), []
        for count, row in enumerate(rows):
            start = frame.coordinates(self.plan.start[row], LINEAR)
            feature = str(self.plan.feature[row])
            anchor = " (ANCHOR)" if self.plan.request[row] < 0 else ""
            direction = list(self.plan.direction[row])
            touch = Touch(direction, self.plan.distance, feeds.probing, options.standoff)
            out += [
                k.comment(f"TOUCH {row + 1} ON {feature}{anchor}"),
                k.assign(Q.TOUCH, row + 1),
                k.assign(Q.FEATURE, self.number[feature]),
                k.assign(Q.STATUS, -1),
                k.line({a: start[a] for a in "XY"}, None),
                *([up] if count == 0 else []),  # each touch ends at this height
                k.line({"Z": start["Z"]}, feeds.approach),
                *k.probe_vector(self.dialect, Q.RESULT_X, touch),
                k.call(Label.LOG),
                k.line(start, feeds.approach),
                up,
            ]
        return out

    def _dry(self, visit: Visit, rows: IntArray, frame: ProgramFrame) -> list[str]:
        """Moves to the same places at a greater height, without touches."""
        assert self.raised is not None
        k, z, top = self.language, self.plan.chain.axis_index("Z"), self.plan.top
        high = frame.height(visit.height + self.raised, top)
        up, out = k.line({"Z": high}, None), []
        for count, row in enumerate(rows):
            start = frame.coordinates(self.plan.start[row], "XY")
            low = min(frame.coordinate("Z", self.plan.start[row, z] + self.raised), high)
            out += [
                k.comment(f"PLACE OF TOUCH {row + 1} ON {self.plan.feature[row]}"),
                k.line(start, None),
                *([up] if count == 0 else []),
                k.line({"Z": low}, self.feeds.approach),
                up,
            ]
        return out

    def _finish(self, name: str) -> list[str]:
        k, printed = self.language, self._print(f"{SharedMask.END}.A", name)
        logged = [k.wait, printed] if self.raised is None else []
        end = [k.structure("END"), self.retract, *logged]
        return [*end, *self._end_plane(), *self._home(), k.program_stop]

    def _places(self) -> list[str]:
        """Read where the rotary axes stand."""
        named = zip((Q.ROTARY_1, Q.ROTARY_2), self.rotary, strict=False)
        return [self.language.read(q, Datum(a)) for q, a in named]

    def _subprograms(self, name: str) -> list[str]:
        """Test the status and log the touch; retract and stop where there was no contact."""
        k = self.language
        missed = [
            k.label(Label.NO_CONTACT, "NOTRIGGER: NO CONTACT"),
            k.retract_max(self.plan.top),
            k.wait,
            self._print(f"{SharedMask.NO_CONTACT}.A", name),
            k.operator_stop,
            k.stop_with_error(ErrorText.TOUCH_POINT_INACCESSIBLE),
        ]
        if self.raised is not None:
            return self._alarms()
        return [
            k.label(Label.LOG, "CHECK AND LOG ONE TOUCH"),
            k.jump_if_less(Q.STATUS, 0, Label.NO_CONTACT),
            k.wait,
            *self._places(),
            self._print(f"{SharedMask.POINT}.A", name),
            k.label_end,
            *missed,
            *self._alarms(),
        ]


def visit_title(rotary: Sequence[str], count: int, total: int, visit: Visit) -> str:
    """Which visit (from 1) of a program it is, where, and from which side it is reached."""
    words = [
        f"{a}{v / DEG:+.2f} FROM {'BELOW' if s > 0 else 'ABOVE'}"
        for a, v, s in sorted(zip(rotary, visit.rotary, visit.side, strict=True))
    ]
    title = " ".join([f"VISIT {count} OF {total}, POSE {visit.pose + 1}:", *words])
    if len(title) <= _LONGEST_TITLE:
        return title
    return title.replace(" FROM ", " ").replace(" OF ", "/").replace(", POSE", " POSE")
