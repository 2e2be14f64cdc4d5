"""`[[curve]]` of a model file: a smooth curve without a formula, as values with uncertainties."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import Field

from matstd.diagnosis.fit import file_unit
from matstd.twin.files import Table
from matstd.twin.frames import Array
from matstd.twin.laws import Law, law_of
from matstd.twin.model import Effect
from matstd.twin.numbers import significant
from matstd.twin.units import DEG

POINTS = 41  # points of a curve: a tenth of its domain has three
EXTENSION = 0.3  # share of its domain by which a curve is shown beyond it on either side
_OF_VARIABLE = {"rad": ("deg", DEG)}  # unit of a variable in files, and one of it in the base unit


class CurveEntry(Table):
    """`[[curve]]`: what the estimates of a curve amount to, for people and other programs.

    `carrier` moves by `value` where `variable` is `x`, times the shape `times` where there is one.
    Touches were between `domain`: beyond it the value dies away and `u` returns to `size`. Nothing
    is computed from this table: the estimates of `effect` with their covariance predict.
    """

    effect: str
    carrier: str
    variable: str
    times: str = ""
    x_unit: str = ""
    unit: str = ""
    domain: list[float] = Field(min_length=2, max_length=2)
    length: float = Field(gt=0.0)
    size: float = Field(ge=0.0)
    x: list[float]
    value: list[float]
    u: list[float]


def curve_entries(
    effects: Sequence[Effect], theta: Array, covariance: Array
) -> list[dict[str, Any]]:
    """Tables of the curves among some effects.

    Args:
        theta: Estimates of all their parameters, (P,), base units.
        covariance: Of them, (P, P).
    """
    out: list[dict[str, Any]] = []
    start = 0
    for effect in effects:
        count = len(effect.parameters)
        law = law_of(effect)
        if law is not None and law.is_curve_alone and not law.is_surface:
            rows = slice(start, start + count)
            out += _curves(law, theta[rows], covariance[rows, rows])
        start += count
    return out


def _curves(law: Law, theta: Array, covariance: Array) -> list[dict[str, Any]]:
    """One table for every direction of a carrier; none where the other shape has several terms."""
    k = next(i for i, f in enumerate(law.factors) if f.shape.word == "curve")
    factor, others = law.factors[k], [f for i, f in enumerate(law.factors) if i != k]
    if any(len(f.shape.coefficients) > 1 for f in others):
        return []
    first = 0 if k == 0 else len(law.factors[0].shape.places)
    low, high, length, size = law.places[first : first + 4]
    margin = EXTENSION * (high - low)
    x = np.linspace(low - margin, high + margin, POINTS)
    S = np.stack(factor.shape.values(x, low, high, length, size), axis=1)
    x_unit, per = _OF_VARIABLE.get(factor.driver.unit, (factor.driver.unit, 1.0))
    suffix, scale = file_unit(law.carrier.unit)
    out = []
    for way, word in enumerate(law.carrier.words):
        own = slice(way * S.shape[1], (way + 1) * S.shape[1])
        u = np.sqrt(np.maximum(np.einsum("np,pq,nq->n", S, covariance[own, own], S), 0.0))
        values = {"x": x / per, "value": S @ theta[own] / scale, "u": u / scale}
        out.append(
            {
                "effect": law.name,
                "carrier": f"{law.carrier.name} {word}".strip(),
                "variable": factor.driver.name,
                "times": others[0].name if others else "",
                "x_unit": x_unit,
                "unit": "" if suffix == "1" else suffix,
                "domain": [significant(low / per), significant(high / per)],
                "length": significant(length * (high - low) / per),
                "size": significant(size / scale),
                **{key: [significant(float(v)) for v in array] for key, array in values.items()},
            }
        )
    return out
