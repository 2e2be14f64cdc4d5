"""`matstd diagnose`: which effect the model lacks, and how far the error falls with it."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matstd.commands.measured.results import made_in_folder, say_files
from matstd.console import console, say, say_each
from matstd.next_steps import MODELLED, called, kept
from matstd.options import Options, measured, pitches, starting_model
from matstd.twin.units import DEG, MINUTE, UM
from matstd.twin.words import deviations_in, in_own_unit

if TYPE_CHECKING:
    from matstd.api.diagnosing import Diagnosis
    from matstd.diagnosis.answer import Step
    from matstd.twin.compute import Progress
    from matstd.twin.model import Effect
    from matstd.twin.record import Touches

CELL_WIDTH = 40
"""Width in characters of a cell of words, so that the table of figures fits beside them."""


OPTIONS: Options = {
    "run_files RUN.csv ...": "measurements; several runs of one machine (days, set-ups, standards) "
    "in order of time",
    "--hold-out RUN ...": "exclude these runs from the fit (only their set-ups are fitted) and "
    "report how well the others predict them",
    "--add EFFECT ...": "add these effects to the model",
    "--only KIND ...": "search only for effects of these kinds or names",
    "--without KIND ...": "do not search for effects of these kinds or names",
    "--auto": "add every effect that the diagnosis finds, step by step",
    "--no-learn": "learn no law of what remains (matstd learn does the same by itself)",
    **measured("starting model of the diagnosis (default: the ordinary geometric model)"),
}


def run(args: argparse.Namespace) -> int:
    """Diagnose; the folder appears whole or not at all."""
    from matstd.api.diagnosing import Diagnosis, diagnose
    from matstd.progress import turns

    def make(show: Progress) -> Diagnosis:
        return diagnose(
            args.run_files,
            starting_model(args),
            add=args.add,
            auto=args.auto,
            only=args.only,
            without=args.without,
            hold_out=args.hold_out,
            pitch=pitches(args),
            learn=not args.no_learn,
            standard=args.standard,
            progress=turns(show),
        )

    found, arm = made_in_folder(args, Diagnosis, make)
    with deviations_in(found.run.touches.deviation_unit):
        _report(args, found, arm)
    args.next = _next(args, found)
    return 0


def _next(args: argparse.Namespace, found: Diagnosis) -> tuple[str, str]:
    """What follows: mend the description, learn a law, measure, name the effect, or compensate."""
    import numpy as np

    from matstd.diagnosis.answer import Verdict

    model = Path(args.output) / "model.toml"
    if any(row.is_far for row in found.parts.geometry.beyond):
        why = "after the machine file or the run is mended: no table corrects a wrong description"
        return _again(args), why
    if found.withdrawn:
        return _unexplained(args, found)
    if found.verdict is Verdict.MISSING and not args.auto:
        new = (step for step in found.steps if step.effect is not None and not step.is_named)
        named = [step.effect.name for step in new if step.effect is not None]
        more = [word for name in named for word in ("--add", name)]
        why = "with the effect in model.toml; then matstd compensate"
        return _again(args, *more), why
    if found.verdict is Verdict.UNEXPLAINED:
        return _unexplained(args, found)
    if found.verdict is Verdict.UNDECIDED and found.plans:
        plan = Path(args.output) / "next_measurement_1.csv"
        words = _again(args, runs=("new.csv",))
        return words, f"after measuring {plan} into new.csv"
    if found.verdict is Verdict.UNDECIDED:
        why = "after the same programs have run again: repeated touches show the noise"
        if found.found:
            why = "after another run with other readings of the axes"
        return _again(args, runs=("again.csv",)), why
    tool = np.median(found.run.touches.length)
    tables = Path(args.output).parent / "tables"
    own = kept(args, "effects")
    words = called("compensate", model, *own, "--tool-length", f"{tool:g}", "--tables", tables)
    words = " ".join([words, *_last_state(found), "--within", *_probed(found)])
    return words, "judged where the touches were, at the end of the run"


def _again(args: argparse.Namespace, *more: object, runs: Sequence[str] = ()) -> str:
    """The same diagnosis with further words and runs, into another folder."""
    same = kept(args, *MODELLED, "only", "without", "hold_out", "add", "auto")
    return called("diagnose", *args.run_files, *runs, *same, *more, "-o", f"{args.output}-2")


def _last_state(found: Diagnosis) -> list[str]:
    """What the effects of the model follow, as it was at the last touch."""
    from dataclasses import replace

    import numpy as np

    touches, effects = found.run.touches, found.learnt.model.effects
    last = int(np.argmax(touches.time))
    at = touches[np.array([last])]
    is_found = any(step.effect is not None for step in found.steps)
    out = ["--after", f"{touches.time[last] / MINUTE:.0f}"] if is_found else []
    columns = {"temperature": (at.temperature, ".1f"), "value": (at.value, ".6g")}
    for option, (known, digits) in columns.items():
        asked = []
        for name in known:
            others: dict[str, Any] = {option: {n: v for n, v in known.items() if n != name}}
            if _is_short(effects, replace(at, **others)):
                asked.append(f"{name}={known[name][0]:{digits}}")
        out += [f"--{option}", *asked] if asked else []
    if at.spindle_rpm is not None and _is_short(effects, replace(at, spindle_rpm=None)):
        out += ["--rpm", f"{at.spindle_rpm[0]:.0f}"]
    return out


def _is_short(effects: Sequence[Effect], at: Touches) -> bool:
    """Whether a touch lacks something that an effect follows."""
    from matstd.twin.errors import UnknownEffect

    try:
        for effect in effects:
            effect.terms(at)
    except (UnknownEffect, KeyError, TypeError):  # a user's effect may look it up by itself
        return True
    return False


def _probed(found: Diagnosis) -> list[str]:
    """Readings of the touches by axis, mm and degrees, as `--within` has them: `X=-120:118`."""
    import numpy as np

    touches = found.run.touches
    units = np.where([touches.chain.link(a).kind == "rotary" for a in touches.chain.axes], DEG, 1.0)
    low, high = np.ceil(touches.q.min(axis=0) / units), np.floor(touches.q.max(axis=0) / units)
    return [
        f"{name}={low[i]:.0f}:{high[i]:.0f}"
        for i, name in enumerate(touches.chain.axes)
        if name in touches.chain.programmed_axes and low[i] < high[i]
    ]


def _unexplained(args: argparse.Namespace, found: Diagnosis) -> tuple[str, str]:
    """A law gets a name; where none was looked for it is learnt, where there is none, measure."""
    if found.laws is None:
        options = kept(args, *MODELLED, "add")
        words = called("learn", *args.run_files, *options, "-o", f"{args.output}-law")
        return words, "a law of what remains, from the run itself"
    if not found.laws.laws:
        words = _again(args, runs=("again.csv",))
        return words, "after another run that records what could be the cause"
    # laws beside it are learnt anew
    better = [
        one.library.effect.name for one in found.laws.laws if one.is_behind_library and one.library
    ]
    if of_library := found.laws.of_library or list(dict.fromkeys(better)):
        named = [word for name in of_library for word in ("--add", name)]
        return _again(args, *named), "the effect of the library, in place of the law"
    effect = Path(args.output) / "effect.py"
    named = [word for name in found.laws.effect_names for word in ("--add", name)]
    words = _again(args, "--effects", effect, *named)
    return words, "the law by the name that you give it in effect.py"


def _report(args: argparse.Namespace, result: Diagnosis, arm: str) -> None:
    """The verdict, the error falling, what was found to copy, and what else should be known."""
    from rich.table import Column, Table

    from matstd.report.effects import plan_words, rival_words
    from matstd.report.geometry import console_lines
    from matstd.report.laws import law_notes, visit_sentences
    from matstd.report.verdict import part_lines
    from matstd.report.words import remark_sentence, scanned_sentence, verdict_sentence

    say(f"{result.verdict.value}: {verdict_sentence(result)}", style="bold")
    notes = law_notes(result.laws) if result.laws else []
    notes += visit_sentences(result.visit) if result.visit else []
    say_each((*(f"{name}: {words}" for name, words in part_lines(result)), *notes))
    right = ("p", "fitted µm", "held out µm", "chi²/dof")
    numbers = [Column(in_own_unit(word), justify="right", no_wrap=True) for word in right]
    words = [Column(word, overflow="fold", max_width=CELL_WIDTH) for word in ("effect", "size")]
    table = Table(*words, *numbers, box=None)
    for step in result.steps:
        table.add_row(*_row(step, step.effect in result.withdrawn))
    console().print(table)
    for step in result.steps:
        is_found = step.effect is not None and step.effect not in result.withdrawn
        if is_found and (rivals := rival_words(step)):
            say(f"- {rivals}")
    known = result.run.touches, result.geometry, result.faults, result.trend
    for line, is_first in console_lines(*known):
        say(f"- {line}", style="bold" if is_first else None)
    said = arm, *map(remark_sentence, result.remarks), scanned_sentence(result.detectable)
    say_each(filter(None, said))
    is_short = result.learnt is result.steps[result.named].fit
    if is_short and any(not s.is_named for s in result.steps[1:]):
        more = "the law" if result.withdrawn else "what was found, --add NAME one of them"
        say(f"- model.toml holds only effects you named; --auto adds {more}")
    for i, plan in enumerate(result.plans, start=1):
        say(f"- next_measurement_{i}.csv would distinguish {plan_words(plan)}")
    law = ("effect.py (--effects)", "law.json") if result.laws and result.laws.laws else ()
    visit = "next_visit.csv" if result.visit and result.visit.touches else ""
    say_files(args, *law, visit, "diagnosis.json", "model.toml")


def _row(step: Step, is_withdrawn: bool) -> tuple[str, ...]:
    """One step of the table: what was added, how large it is, and how far the error fell."""
    from rich.markup import escape

    from matstd.report.effects import effect_cell
    from matstd.report.numbers import digits
    from matstd.report.words import values

    first = enumerate(values(step)[:2])
    cell = ["withdrawn:"] if is_withdrawn else []
    return (
        escape("\n".join(filter(None, (*cell, *effect_cell(step)))))
        if step.effect
        else "starting model",
        ", ".join(f"{name} {value}" if i else value for i, (name, value) in first),
        f"{step.p_value:.0e}" if step.effect is not None else "",
        f"{step.fit.rms / UM:.3f}",
        f"{step.fit.test_rms / UM:.3f}",
        digits(step.fit.noise.chi2_ratio),
    )
