"""`effect.py`: a law as an effect of the user's own, in thirty lines to be renamed and refined."""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.laws import Estimate, Learning, amplitudes, places
from matstd.report.laws.law_words import amplitude_words, formula_words, place_words
from matstd.twin.laws import Law
from matstd.twin.units import UM, URAD

HEAD = '''"""{title}

    matstd diagnose RUN.csv --effects THIS.py --add {first} -o OUT

Learnt from {run}. A law has no cause yet: rename it when you know what it is.
"""

from dataclasses import dataclass

import numpy as np

{imports}

'''

CLASS = '''
@dataclass(frozen=True)
class {name}(Declared):
    """{summary}"""
{fields}
    kind{acts} = "{kind}"{entry}
    parameters = ({parameters},)

    def {method}(self, touches):
{body}


{constant} = Kind.of(
    {name},
    formula="{formula}",
    units="{units}",
    typical="{typical}",
    source="learnt from {run}",
)
'''

CURVE_KNOTS, CURVE_FLANKS = 41, 3.0
"""Knots of a table that stands for a curve without a formula, and correlation lengths by which it
goes beyond the domain: there it has died away."""


def effect_text(learning: Learning, run: str) -> str:
    """Text of `effect.py`."""
    names = learning.effect_names
    blocks = [
        _class(learning, one.law, name, run) for one, name in zip(learning.laws, names, strict=True)
    ]
    body = "".join(blocks)
    laws = [law for law in ("SHAPES", "carrier_of", "driver_of", "play") if f"{law}(" in body]
    model = ["Declared", "Kind", "Parameter"]
    model += [word for word in ("Term", "scanned") if f"{word}(" in body]
    units = [word for word in ("DEG", "HOUR", "MINUTE", "UM", "URAD") if f" {word}" in body]
    imports = [f"from matstd.twin.laws import {', '.join(laws)}"] if laws else []
    imports.append(f"from matstd.twin.model import {', '.join(model)}")
    imports += [f"from matstd.twin.units import {', '.join(units)}"] if units else []
    titles = "; ".join(formula_words(one.law) for one in learning.laws)
    title = f"{titles}." if len(titles) < 95 else "Laws that matstd learn found."
    head = HEAD.format(title=title, first=names[0], run=run, imports="\n".join(imports))
    return head + body.lstrip("\n").join(["\n", ""])


def _class(learning: Learning, law: Law, kind: str, run: str) -> str:
    """The class of one law with its card."""
    name = "".join(word.capitalize() for word in kind.split("-"))
    estimates = places(learning, law)
    is_entry = law.carrier.symbol is not None or law.carrier.name == "bias"
    entry = f', "{law.carrier.name}"' if is_entry else ""
    typical = "; ".join(amplitude_words(a) for a in amplitudes(learning, law)[:3])
    return CLASS.format(
        name=name,
        summary=f"{formula_words(law)}.",
        fields="".join(_field(law, i, e) for i, e in enumerate(estimates) if i in law.free)
        + ("\n" if law.free else ""),
        acts=", acts_on" if is_entry else "",
        kind=kind,
        entry=entry,
        parameters=", ".join(_parameter(p) for p in _parameters(learning, law)),
        method="amounts" if is_entry else "terms",
        body=_body(learning, law, estimates, is_entry),
        constant=kind.upper().replace("-", "_"),
        formula=formula_words(law),
        units="; ".join([f"a: {_UNITS.get(law.carrier.unit, law.carrier.unit)}", *_units(law)]),
        typical=typical,
        run=run,
    )


_UNITS = {"mm": "µm", "rad": "µrad"}


def _units(law: Law) -> list[str]:
    """`x0: mm` of every parameter that the run determines."""
    return [f"{law.place_names[i]}: {law.units[i]}" for i in law.free]


def _field_name(name: str) -> str:
    return name.replace("-", "_")


def _field(law: Law, index: int, one: Estimate) -> str:
    """A scanned field about the value that was found."""
    jumps = [f.shape.jumps for f in law.factors for _ in f.shape.places][index]
    is_time = [f.driver.nature == "time" for f in law.factors for _ in f.shape.places][index]
    half = 3.0 * one.u if one.u else 0.1 * abs(one.value) or 1.0
    unit = one.unit if one.unit in ("mm", "rad", "s") else "1"
    if one.name.split("-")[0] in ("w", "wa", "wb", "period", "p"):
        half = min(half, 0.5 * abs(one.value))
    acts = ', acts="at an instant"' if jumps and is_time else ""
    found = f"{one.value:.6g}"
    note = f"  # found {place_words(one)}" if one.u else ""
    grid = f"np.linspace({one.value - half:.6g}, {one.value + half:.6g}, 9)"
    line = f'    {_field_name(one.name)}: float = scanned("{unit}", {grid}, {found}{acts})'
    return f"\n{line}" if len(line) + len(note) > 99 else f"\n{line}{note}"


def _parameters(learning: Learning, law: Law) -> list[Estimate]:
    """Amplitudes of the file: those of the law, or one on the table of a curve."""
    found = amplitudes(learning, law)
    if not law.is_curve_alone:
        return found
    size = max(abs(a.value) for a in found)
    unit = law.carrier.unit
    return [Estimate(word or "amplitude", size, None, unit) for word in law.carrier.words]


def _parameter(one: Estimate) -> str:
    """`Parameter("amplitude", "mm", 10 * UM)`: the size that was found, as what is expected."""
    if one.unit == "mm":
        return f'Parameter("{one.name}", "mm", {max(abs(one.value) / UM, 1.0):.3g} * UM)'
    if one.unit == "rad":
        return f'Parameter("{one.name}", "rad", {max(abs(one.value) / URAD, 1.0):.3g} * URAD)'
    return f'Parameter("{one.name}", "{one.unit}", {abs(one.value):.3g})'


def _body(learning: Learning, law: Law, estimates: Sequence[Estimate], is_entry: bool) -> str:
    """Lines of the method: the variable, the shape, and what it moves."""
    lines, start, products = [], 0, [""]
    for k, factor in enumerate(law.factors):
        x = "x" if len(law.factors) == 1 else f"x{k + 1}"
        lines.append(f"{x} = {_variable(factor.driver.name)}")
        count = len(factor.shape.places)
        if factor.shape.word == "curve":
            found = [_table(learning, law, k)]
        else:
            values = {}
            for i, name in enumerate(factor.shape.places):
                is_field = (start + i) in law.free
                own = estimates[start + i]
                values[name] = f"self.{_field_name(own.name)}" if is_field else f"{own.value:.6g}"
            found = [_with(code, x).format(**values) for code in factor.shape.code]
        products = [f"{a} * {_bracketed(b)}" if a else b for a in products for b in found]
        start += count
    if is_entry:
        lines.append(f"return ({', '.join(products)},)")
    else:
        lines.append(f"amounts = ({', '.join(products)},)")
        lines.append(f'entries = carrier_of("{law.carrier.name}", touches.chain).entries(touches)')
        m = len(products)
        lines.append("return tuple(")
        lines.append(f"    Term({m} * way + k, where, factor * amount)")
        lines.append("    for way, where, factor in entries")
        lines.append("    for k, amount in enumerate(amounts)")
        lines.append(")")
    return "\n".join(f"        {line}" for line in lines)


def _with(code: str, x: str) -> str:
    """The expression with its own variable; `x0`, `np.exp` and the like stay."""
    import re

    return re.sub(r"(?<![\w{.])x(?![\w}])", x, code)


def _bracketed(code: str) -> str:
    return code if code.startswith("np.") and code.count("(") == 1 else f"({code})"


def _variable(name: str) -> str:
    """How a variable is read from touches."""
    if name == "time":
        return "touches.since_start"
    if name.startswith("T-"):
        return f'touches.temperature["{name.removeprefix("T-")}"]'
    if name.startswith("V-"):
        return f'touches.value["{name.removeprefix("V-")}"]'
    if name.startswith("last-"):
        return f'touches.last_move("{name.removeprefix("last-")}")'
    if name == "rpm":
        return "touches.spindle_rpm"
    if len(name) <= 2:
        return f'touches.reading("{name}")'
    return f'driver_of("{name}", touches.chain).values(touches)'


def _table(learning: Learning, law: Law, factor: int) -> str:
    """A curve without a formula as a table between which is interpolated, its largest value 1."""
    from matstd.diagnosis.laws import curve_of

    start = 0 if factor == 0 else len(law.factors[0].shape.places)
    low, high, length, _ = law.places[start : start + 4]
    flank = CURVE_FLANKS * length * (high - low)
    low, high = low - flank, high + flank
    x = np.linspace(low, high, CURVE_KNOTS)
    y, _ = curve_of(learning, law, factor, x)
    y = y / max(float(np.abs(y).max()), 1e-300)
    knots = f"np.linspace({low:.6g}, {high:.6g}, {CURVE_KNOTS})"
    return f"np.interp(x, {knots}, [{', '.join(f'{v:.3f}' for v in y)}])"
