"""Logs before evaluation: every touch once, and entries that cannot be right."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from itertools import pairwise

import numpy as np

from matstd.artefact.body import Standard
from matstd.probe_paths.campaign.as_programmed import check_numbers
from matstd.probe_paths.campaign.stamps import check_log_stamp
from matstd.probe_paths.control import UNDATED, LogPart
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.rows import picked
from matstd.twin.units import NM

LARGEST_OFFSET = 0.1
"""Largest offset of a centred stylus, mm: ten times the reading of a dial gauge."""


def distinct_parts(parts: Sequence[LogPart]) -> list[LogPart]:
    """Parts in the order of time, every touch of a run of a program once; raises BadFile.

    The same log may be given twice, whole and cut off: its parts have the same program and begin.
    """
    found: list[LogPart] = []
    for part in sorted(_dated(parts), key=lambda part: (part.begin, -len(part.number))):
        twin = next((p for p in found if (p.program, p.begin) == (part.program, part.begin)), None)
        if twin is None:
            found.append(part)
            continue
        _check_alike(twin, part)
        new = ~np.isin(part.number, twin.number)
        remark = f"{int(np.sum(~new))} touches stand in {twin.path} too and count once"
        if not np.any(new):
            i = found.index(twin)
            found[i] = replace(twin, remarks=(*twin.remarks, f"{part.path}: {remark}"))
            continue
        found.append(replace(picked(part, np.flatnonzero(new)), remarks=(*part.remarks, remark)))
    return found


def _dated(parts: Sequence[LogPart]) -> list[LogPart]:
    """Parts with missing dates set to the earliest day of the others."""
    days = [part.begin for part in parts if part.begin.year != UNDATED.year]
    if not days:
        return list(parts)
    first = min(days)
    remark = f"its date is taken from another log, {first.date()}"
    return [
        part
        if part.begin.year != UNDATED.year
        else replace(
            part,
            begin=datetime.combine(first.date(), part.begin.time()),
            remarks=(*part.remarks, remark),
        )
        for part in parts
    ]


def _check_alike(one: LogPart, other: LogPart) -> None:
    """Refuse different numbers for the same touch."""
    numbers, i, k = np.intersect1d(one.number, other.number, return_indices=True)
    differ = np.any(np.abs(one.xyz[i] - other.xyz[k]) > NM, axis=1)
    if np.any(differ):
        row = int(np.argmax(differ))
        found = f"touch {numbers[row]} of the run of {other.program} at {other.begin}"
        expected = f"the same numbers as in {one.path}, line {one.line[i[row]]}"
        raise BadFile(other.path, other.line[k[row]], found, expected)


def checked_parts(
    parts: Sequence[LogPart], standard: Standard, chain: Chain
) -> tuple[list[LogPart], list[str]]:
    """Parts without touches of features that the standard lacks, and remarks on all of them.

    Raises:
        DesignError: A log of another standard or another design of it.
        BadFile: A log of another machine, nothing but such touches in a part, or numbers that
            cannot be right (`check_numbers`).
    """
    check_numbers(parts, chain)
    kept: list[LogPart] = []
    remarks = [f"{part.path}: {remark}" for part in parts for remark in part.remarks]
    count = len(standard.features)
    for part in parts:
        check_log_stamp(part.path, part.heading, standard)
        part.heading.check_machine(chain, part.path)
        good = (part.feature >= 1) & (part.feature <= count)
        if len(good) and not np.any(good):
            found, expected = (
                f"feature {part.feature[0]}",
                f"1 to {count}, a feature of {standard.name}",
            )
            raise BadFile(part.path, part.line[0], found, expected)
        remarks += [
            f"{part.path}: line {part.line[i]}: feature {part.feature[i]} is none of 1 to {count}; "
            f"touch {part.number[i]} is left out"
            for i in np.flatnonzero(~good)
        ]
        if part.offset > LARGEST_OFFSET:
            remarks.append(
                f"{part.path}: {part.program}: the ball is calibrated {part.offset:.3f} mm off the "
                "spindle axis: centre the stylus, or recalibrate the probe"
            )
        kept.append(picked(part, np.flatnonzero(good)))
    return kept, remarks + _overlaps(kept)


def _overlaps(parts: Sequence[LogPart]) -> list[str]:
    """Remarks on programs that overlap in time: the clock was set in between."""
    remarks = []
    for one, other in pairwise(part for part in parts if len(part.number)):
        end = one.begin + timedelta(seconds=float(one.time[-1]))
        if other.begin < end:
            remarks.append(
                f"{other.path}: {other.program} begins at {other.begin}, before {one.program} ends "
                f"at {end}: the clock was set between them, and times are not in order"
            )
    return remarks


def without_rows(parts: Sequence[LogPart], good: np.ndarray) -> list[LogPart]:
    """Parts without some touches; `good` (N,) counts through all of them."""
    ends = np.cumsum([len(part.number) for part in parts])
    return [
        picked(part, np.flatnonzero(good[end - len(part.number) : end]))
        for part, end in zip(parts, ends, strict=True)
    ]


def logged_temperatures(parts: Sequence[LogPart]) -> tuple[dict[str, Array], list[str]]:
    """Temperatures that the control logged, each (N,) degC, and remarks on those left out.

    A missing reading is interpolated; implausible temperatures are left to the reader of runs.
    """
    out: dict[str, Array] = {}
    remarks = []
    for name in dict.fromkeys(name for part in parts for name in part.temperature):
        lots = [part.temperature.get(name, np.full(len(part.number), np.nan)) for part in parts]
        values, at = np.concatenate(lots), np.arange(sum(map(len, lots)))
        good = np.isfinite(values)
        if not good.all():
            remarks.append(f"T_{name}_degC: the control logged {int(good.sum())} of {len(good)}")
        if good.any():
            out[name] = np.interp(at, at[good], values[good])
    return out, remarks
