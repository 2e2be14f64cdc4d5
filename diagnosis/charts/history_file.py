"""trend.json ("trend/1") and trend.csv: a machine over several occasions, for other programs."""

from datetime import timedelta
from typing import Any

from matstd.diagnosis.charts.chart import ControlChart
from matstd.diagnosis.charts.course import ALPHA
from matstd.diagnosis.charts.machine_history import History
from matstd.diagnosis.geometry import Estimate
from matstd.twin.numbers import significant
from matstd.twin.text import csv_text
from matstd.twin.units import UM, URAD

FORMAT = "trend/1"

UNITS = {"mm": ("um", UM), "rad": ("urad", URAD), "1": ("ppm", 1e-6)}
"""Suffix in files of a unit, and one of it in the base unit."""


def history_table(found: History) -> dict[str, Any]:
    """Everything of `trend.json`, in the units that stand in its names."""
    first = found.occasions[0]
    return {
        "format": FORMAT,
        "machine": first.chain.name,
        "machine_hash": first.chain.fingerprint,
        "standard": next((one.standard for one in found.occasions if one.standard), ""),
        "is_dated": found.is_dated,
        "alpha": ALPHA,
        "widening": significant(found.widening),
        "occasions": [
            {
                "name": one.name,
                "date": None if one.date is None else one.date.isoformat(),
                "touches": one.touches,
            }
            for one in found.occasions
        ],
        "charts": [_chart(found, chart) for chart in found.charts],
    }


def history_csv(found: History) -> str:
    """Every value of every chart, a row each."""
    rows = [
        [
            one.name,
            "" if one.date is None else one.date.isoformat(),
            chart.of.quantity.value,
            chart.of.symbol,
            UNITS[chart.of.unit][0],
            *(significant(v / UNITS[chart.of.unit][1]) for v in numbers),
            int(k in chart.beyond),
        ]
        for chart in found.charts
        for part in chart.segments
        for k in range(part.first, part.last + 1)
        for one in [found.occasions[chart.rows[k]]]
        for numbers in [
            (chart.values[k].value, chart.values[k].u, part.centre.value, *chart.limits(part))
        ]
    ]
    names = "occasion,date,quantity,symbol,unit,value,uncertainty,centre,lower_limit,upper_limit"
    return csv_text([*names.split(","), "is_beyond"], rows)


def _chart(found: History, chart: ControlChart) -> dict[str, Any]:
    """One chart; None where nothing is known."""
    suffix, unit = UNITS[chart.of.unit]
    drift, scatter = chart.course.drift, chart.scatter
    names = [found.occasions[i].name for i in chart.rows]

    def scaled(value: float) -> float:
        return significant(value / unit)

    def pair(name: str, estimate: Estimate) -> dict[str, float]:
        ends = (f"{name}_{suffix}", f"{name}_uncertainty_{suffix}")
        return dict(zip(ends, (scaled(estimate.value), scaled(estimate.u)), strict=True))

    return {
        "quantity": chart.of.quantity.value,
        "symbol": chart.of.symbol,
        "axes": list(chart.of.axes),
        "occasions": names,
        f"value_{suffix}": [scaled(e.value) for e in chart.values],
        f"uncertainty_{suffix}": [scaled(e.u) for e in chart.values],
        "limits": {
            "source": chart.source.value,
            f"stated_{suffix}": scaled(chart.stated),
            f"scatter_{suffix}": None if scatter is None else scaled(scatter),
            "segments": [
                {
                    "first": names[part.first],
                    "last": names[part.last],
                    **pair("centre", part.centre),
                    f"lower_{suffix}": scaled(chart.limits(part)[0]),
                    f"upper_{suffix}": scaled(chart.limits(part)[1]),
                }
                for part in chart.segments
            ],
        },
        "beyond": [names[k] for k in chart.beyond],
        "steps": [
            {
                "into": names[step.after],
                **_date(found, step.date),
                "date_uncertainty_days" if found.is_dated else "place_uncertainty": significant(
                    step.u_date
                ),
                **pair("change", step.size),
                "p_value": step.p_value,
            }
            for step in chart.course.steps
        ],
        "drift": None
        if drift is None
        else {
            **pair("per_day" if found.is_dated else "per_occasion", drift.rate),
            "p_value": drift.p_value,
        },
    }


def _date(found: History, days: float) -> dict[str, Any]:
    """A date where there are dates, else a place between occasions counted from one."""
    if found.begin is None:
        return {"place": significant(days + 1.0)}
    return {"date": (found.begin + timedelta(days=days)).isoformat(timespec="minutes")}
