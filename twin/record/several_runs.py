"""Several runs of one machine as one."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from matstd.twin.errors import DesignError
from matstd.twin.record.copies import without_copies
from matstd.twin.record.run import PER_ROW, Run
from matstd.twin.record.touches import MAPS, PER_TOUCH, Setup, Touches

PAUSE = 3600.0
"""Pause between runs, s: long enough for bodies and noise to be independent; every run also counts
its own time (`Touches.since_start`)."""


def joined(runs: Mapping[str, Run]) -> Run:
    """One run of several by their names, in their order; set-ups bear the name of their run.

    Every run keeps its set-ups, its time and its poses. Of sensors and of columns of the user's own
    those are kept that all runs have, and a remark says which are not.

    Raises:
        DesignError: No run, another machine, another instrument, or the same measurements twice.

    Example:
        ``diagnose(joined({"spring": read_run("spring.csv"), "autumn": read_run("autumn.csv")}))``
    """
    if not runs:
        raise DesignError("no run, expected at least one")
    parts = [without_copies(run) for run in runs.values()]
    names = list(runs)
    if len(parts) == 1:
        return parts[0]
    _check_alike(names, parts)
    every = [part.touches for part in parts]
    # times of all runs on one axis, so that noise and lags of one do not reach the next
    starts = _starts(every)
    setups = [
        replace(s, name=f"{name}/{s.name}", run=name, start=begin)
        for name, t, begin in zip(names, every, starts, strict=True)
        for s in t.setups
    ]
    first = np.cumsum([0, *(len(t.setups) for t in every[:-1])])
    moved = [
        replace(t, setup=t.setup + k, time=t.time + s)
        for t, k, s in zip(every, first, starts, strict=True)
    ]
    touches = stacked(moved, tuple(setups))
    stamps = {part.standard for part in parts}
    of_parts = (f"{n}: {text}" for n, p in zip(names, parts, strict=True) for text in p.remarks)
    return Run(
        touches=touches,
        **{name: _all_of([getattr(part, name) for part in parts]) for name in PER_ROW},
        remarks=(*_dropped(names, every), *of_parts),
        moved=tuple(
            replace(one, name=f"{n}/{one.name}")
            for n, part in zip(names, parts, strict=True)
            for one in part.moved
        ),
        standard=stamps.pop() if len(stamps) == 1 else "",
    )


def _check_alike(names: Sequence[str], parts: Sequence[Run]) -> None:
    """Refuse runs that are not of one machine, or one twice."""
    first = parts[0].touches
    for name, part in zip(names[1:], parts[1:], strict=True):
        differs = part.touches.chain.difference(first.chain)
        if differs is not None:
            key, here, there = differs
            raise DesignError(
                f"{name}: of another machine than {names[0]}: {key} is {here}, expected {there}; "
                "runs are diagnosed together only if they are of one machine"
            )
        if part.touches.instrument is not first.instrument:
            raise DesignError(
                f"{name}: measured by {part.touches.instrument.value}, expected "
                f"{first.instrument.value} as in {names[0]}"
            )
    marks = {part.fingerprint: name for name, part in zip(names, parts, strict=True)}
    for name, part in zip(names, parts, strict=True):
        if marks[part.fingerprint] != name:
            raise DesignError(
                f"{marks[part.fingerprint]}: the same measurements as {name}, expected every run "
                "once: no touch counts twice"
            )


def _starts(every: Sequence[Touches]) -> list[float]:
    """Time at which every run starts, s: one after the other, with a pause between them."""
    starts, end = [], 0.0
    for touches in every:
        starts.append(end - min(float(touches.time.min()), 0.0))
        end = starts[-1] + float(touches.time.max()) + PAUSE
    return starts


def stacked(every: Sequence[Touches], setups: tuple[Setup, ...]) -> Touches:
    """Touches of one machine, one record after the other; a column is kept that all have.

    `Touches.setup` of every record already counts in the set-ups of all of them.
    """
    columns = {name: _all_of([getattr(t, name) for t in every]) for name in PER_TOUCH}
    for kind in MAPS:
        records = [getattr(t, kind) for t in every]
        common = [name for name in records[0] if all(name in r for r in records)]
        columns[kind] = {name: np.concatenate([r[name] for r in records]) for name in common}
    return replace(every[0], setups=setups, **columns)


def _all_of(values: Sequence[Any]) -> Any:
    """One column of all runs; None where one of them has none."""
    return None if any(v is None for v in values) else np.concatenate(values)


def _recorded(touches: Touches) -> list[str]:
    """What a run recorded beside its touches, as its columns are called."""
    out = [f"T_{s}_degC" for s in touches.temperature] + [f"V_{v}" for v in touches.value]
    out += ["spindle_rpm"] if touches.spindle_rpm is not None else []
    return out + (["Fx_N, Fy_N, Fz_N"] if touches.force is not None else [])


def _dropped(names: Sequence[str], every: Sequence[Touches]) -> list[str]:
    """A remark on every column that not all runs have."""
    have = {name: _recorded(t) for name, t in zip(names, every, strict=True)}
    columns = dict.fromkeys(c for own in have.values() for c in own)
    return [
        f"{column} is not in {', '.join(n for n in names if column not in have[n])}: left out, "
        "since effects are common to all runs"
        for column in columns
        if any(column not in own for own in have.values())
    ]
