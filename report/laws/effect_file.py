"""`effect.py`: a law as an effect of the user's own, in thirty lines to be renamed and refined."""

import itertools
import keyword
import math
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.laws import Estimate, Learning, amplitudes, curve_of, places
from matstd.report.laws.law_words import amplitude_words, formula_words, place_words, size_words
from matstd.twin.frames import Array
from matstd.twin.laws import SURFACE_WAVES, Driver, Law, surface_waves
from matstd.twin.units import UM, URAD

HEAD = '''"""{title}

    matstd diagnose RUN.csv --effects THIS.py --add {first} -o OUT

Learnt from {run}. A law has no cause yet: rename it when you know what it is.{form}
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
    kind{acts} = "{kind}"{entry}{part}
    parameters = {parameters}

    def {method}(self, touches):
{body}


{constant} = Kind.of(
    {name},
    formula="{formula}",
    units="{units}",
    typical="{typical}",
    source="learnt from {run}",
{owner})
'''

FORM = """
The form without a formula is that of the run and is not fitted again; its uncertainty is in
model.toml."""

OF_READING = (
    "\n    is_of_reading = True  # it is a part of {}, which the geometry reports as a whole"
)

OF_ITS_RUN = '    belongs_to="run",  # its driver was not recorded: other runs need not repeat it\n'

CURVE_KNOTS, CURVE_FLANKS = 6, 3.0
"""Knots in a correlation length of a table that stands for a curve without a formula, and lengths
by which it goes beyond the domain: there it has died away."""


def effect_text(learning: Learning, run: str) -> str:
    """Text of `effect.py`."""
    names, run = learning.effect_names, run.replace("\\", "/").replace('"', "'")
    body = "".join(
        _class(learning, one.law, name, run) for one, name in zip(learning.laws, names, strict=True)
    )
    used = [
        ("matstd.twin.laws", ("carrier_of", "driver_of", "play"), r"\b{}[([]"),
        ("matstd.twin.model", ("Declared", "Kind", "Parameter", "scanned"), r"\b{}\b"),
        ("matstd.twin.units", ("UM", "URAD"), r" {}\b"),
    ]
    imports = []
    for module, words, pattern in used:
        found = [word for word in words if re.search(pattern.format(word), body)]
        imports += [f"from {module} import {', '.join(found)}"] if found else []
    titles = "; ".join(formula_words(one.law) for one in learning.laws)
    title = f"{titles}." if len(titles) < 95 else "Laws that matstd learn found."
    form = FORM if any(one.law.is_curve_alone for one in learning.laws) else ""
    head = HEAD.format(title=title, first=names[0], run=run, imports="\n".join(imports), form=form)
    return head + body.lstrip("\n").join(["\n", ""])


def _class(learning: Learning, law: Law, kind: str, run: str) -> str:
    """The class of one law with its card."""
    name = "".join(word.capitalize() for word in kind.split("-"))
    estimates = places(learning, law)
    scans = replace(law, is_sought=False).inner(learning.after.run.touches)
    fields = [_field(law, i, estimates[i], scans[i].grid) for i in _free(law)]
    is_entry = law.carrier.symbol is not None or law.carrier.name == "bias"
    entry = f', "{law.carrier.name}"' if is_entry else ""
    units = [f"{law.place_names[i]}: {law.units[i]}" for i in _free(law)]
    typical = "; ".join(amplitude_words(law, a) for a in amplitudes(learning, law)[:3])
    if law.is_curve_alone:
        typical = size_words(learning, law)
    return CLASS.format(
        name=name,
        summary=f"{formula_words(law)}.",
        fields="".join(fields) + ("\n" if fields else ""),
        acts=", acts_on" if is_entry else "",
        kind=kind,
        entry=entry,
        part=OF_READING.format(law.carrier.name) if law.is_of_reading else "",
        parameters=_tuple([_parameter(p) for p in _parameters(learning, law)], 4),
        method="amounts" if is_entry else "terms",
        body=_body(learning, law, estimates, is_entry),
        constant=kind.upper().replace("-", "_"),
        formula=formula_words(law),
        units="; ".join([f"a: {_UNITS.get(law.carrier.unit, law.carrier.unit)}", *units]),
        typical=typical,
        run=run,
        owner="" if law.belongs_to == "machine" else OF_ITS_RUN,
    )


_UNITS = {"mm": "µm", "rad": "µrad"}


def _free(law: Law) -> tuple[int, ...]:
    """Parameters that stand in the file: of a curve over a single variable the table holds all."""
    return () if law.is_curve_alone and len(law.drivers) == 1 else law.free


def _tuple(parts: Sequence[str], indent: int) -> str:
    """A tuple on one line, or on a line each."""
    line = f"({', '.join(parts)},)" if len(parts) == 1 else f"({', '.join(parts)})"
    if len(line) < 80:
        return line
    inner = "".join(f"{' ' * (indent + 4)}{part},\n" for part in parts)
    return f"(\n{inner}{' ' * indent})"


def _field_name(name: str) -> str:
    return name.replace("-", "_")


def _field(law: Law, index: int, one: Estimate, scan: Array) -> str:
    """A scanned field about the value that was found: within 3 u, or as far as the model scans."""
    factor, own = next(part for part in law.parts if index < part[1].stop)
    is_instant = factor.driver.nature == "time" and index - own.start in factor.shape.edges
    half = 3.0 * one.u if one.u else 0.5 * float(np.ptp(scan))
    unit = one.unit if one.unit in ("mm", "rad", "s") else "1"
    if one.name.split("-")[0] in ("w", "wa", "wb", "period", "p"):
        half = min(half, 0.5 * abs(one.value))
    acts = ', acts="at an instant"' if is_instant else ""
    decimals = 2 - math.floor(math.log10(half))
    found = f"{round(one.value, decimals + 2):.12g}"
    note = f"  # found {place_words(one)}" if one.u else ""
    low, high = (round(one.value + sign * half, decimals) for sign in (-1.0, 1.0))
    grid = f"np.linspace({low:.12g}, {high:.12g}, 9)"
    line = f'    {_field_name(one.name)}: float = scanned("{unit}", {grid}, {found}{acts})'
    return f"\n{line}" if len(line) + len(note) > 99 else f"\n{line}{note}"


def _parameters(learning: Learning, law: Law) -> list[Estimate]:
    """Amplitudes of the file: those of the law, or one on the table of a curve."""
    found = amplitudes(learning, law)
    if not law.is_curve_alone:
        return found
    if law.is_surface:
        size = _surface(learning, law)[1]
    else:
        k = next(k for k, factor in enumerate(law.factors) if factor.shape.word == "curve")
        size = float(np.abs(_curve(learning, law, k)[1]).max())
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
    """Lines of the method: the variables, the shapes, and what they move."""
    shape_names, letters, names = _names(law)
    lines = [f"{names[driver]} = {_variable(driver.name)}" for driver in law.drivers]
    if law.is_surface:
        lines += _series(learning, law, [names[driver] for driver in law.drivers])
        return "\n".join(f"        {line}" for line in lines)
    shapes = _shapes(learning, law, estimates, names)
    if len(shapes) == 1:
        products = _tuple(shapes[0], 8)
    else:
        each = list(zip(shape_names, letters, shapes, strict=True))
        for name, _, code in each:
            lines.append(f"{name} = {code[0] if len(code) == 1 else _tuple(code, 8)}")
        loops = " ".join(f"for {letter} in {name}" for name, letter, code in each if len(code) > 1)
        product = " * ".join(letter if len(code) > 1 else name for name, letter, code in each)
        products = f"tuple({product} {loops})" if loops else f"({product},)"
    if not is_entry:
        lines.append(f'carrier = carrier_of("{law.carrier.name}", touches.chain)')
        products = f"carrier.terms(touches, {products})"
    lines.append(f"return {products}")
    return "\n".join(f"        {line}" for line in lines)


def _shapes(
    learning: Learning, law: Law, estimates: Sequence[Estimate], names: dict[Driver, str]
) -> list[list[str]]:
    """Code of every coefficient of every shape; of a curve over a single variable one table."""
    if law.is_curve_alone and len(law.drivers) == 1:
        curve = next(k for k, f in enumerate(law.factors) if f.shape.word == "curve")
        return [[_table(learning, law, curve, names[law.drivers[0]])]]
    written = [
        f"self.{_field_name(one.name)}" if i in law.free else f"{one.value:.6g}"
        for i, one in enumerate(estimates)
    ]
    out = []
    for k, (factor, own) in enumerate(law.parts):
        values, x = dict(zip(factor.shape.places, written[own], strict=True)), names[factor.driver]
        plain = _from_zero(factor.shape.code, values)
        code = [_with(c, x).format(**values).replace("- -", "+ ") for c in plain]
        out.append(code or [_table(learning, law, k, x)])
    return out


def _from_zero(code: Sequence[str], values: dict[str, str]) -> Sequence[str]:
    """Expressions without a zero that is 0."""
    if values.get("zero") != "0":
        return code
    return [c.replace("(x - {zero})", "x").replace("x - {zero}", "x") for c in code]


def _with(code: str, x: str) -> str:
    """The expression with its own variable; `x0`, `np.exp` and the like stay."""
    return re.sub(r"(?<![\w{.])x(?![\w}])", x, code)


_TAKEN = (
    *("self", "touches", "np", "tuple", "play", "carrier", "carrier_of", "driver_of"),
    *("shares", "inside", "one", "other", "beyond", "kept"),
)
"""Names that the method of a law uses beside those of its variables and shapes."""


def _names(law: Law) -> tuple[list[str], list[str], dict[Driver, str]]:
    """Names of the shapes, letters for their coefficients, and names of the variables.

    All are valid in Python and distinct: `y` of Y, `last_x` of last-X, `spindle` of T-spindle.
    A sensor whose short name is taken or invalid keeps its letter: `t_x`, `v_2nd_tank_bar`.
    """
    taken = set(_TAKEN)

    def distinct(*wanted: str) -> str:
        words = [_word(name) for name in wanted]
        numbered = (f"{words[-1]}_{k}" for k in itertools.count(2))
        name = next(w for w in itertools.chain(words, numbered) if w not in taken and _is_name(w))
        taken.add(name)
        return name

    shapes = [distinct(factor.shape.word) for factor in law.factors]
    letters = [distinct(factor.shape.word[0]) for factor in law.factors]
    readings = sorted(law.drivers, key=lambda driver: driver.name[:2] in ("T-", "V-"))
    short = {driver: driver.name.removeprefix("T-").removeprefix("V-") for driver in readings}
    return shapes, letters, {d: distinct(name, d.name) for d, name in short.items()}


def _word(name: str) -> str:
    """A name with `_` for what cannot stand in a name of Python, which knows it in form NFKC."""
    text = unicodedata.normalize("NFKC", name.lower())
    return "".join(c if f"a{c}".isidentifier() else "_" for c in text)


def _is_name(word: str) -> bool:
    return word.isidentifier() and not keyword.iskeyword(word)


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


def _curve(learning: Learning, law: Law, k: int) -> tuple[Array, Array]:
    """Knots of a curve without a formula and its values there, in units of the carrier."""
    low, high, length, _ = law.places[law.parts[k][1]]
    flank = CURVE_FLANKS * length * (high - low)
    count = 1 + round(CURVE_KNOTS * (1.0 / length + 2.0 * CURVE_FLANKS))
    x = np.linspace(low - flank, high + flank, count)
    return x, curve_of(learning, law, law.factors[k].driver, x)[0]


def _surface(learning: Learning, law: Law) -> tuple[Array, float]:
    """Amplitudes of the waves of a surface, (12, 12), and its largest value at the touches."""
    theta = learning.after.theta[learning.after.of_effect(law.name)]
    length, size = law.places[2:4]
    C = np.zeros(SURFACE_WAVES.max(axis=0) + 1)
    C[tuple(SURFACE_WAVES.T)] = size * surface_waves(length) * theta[: len(SURFACE_WAVES)]
    value = np.stack(law.amounts(learning.after.run.touches), axis=1) @ theta
    return C, float(np.abs(value).max())


def _series(learning: Learning, law: Law, names: Sequence[str]) -> list[str]:
    """Lines that give a surface as products of cosines, its largest value 1, dying away outside."""
    C, size = _surface(learning, law)
    domains = [law.places[own][:2] for _, own in law.parts]
    shares = [
        f"({x} - {low:.6g}) / {high - low:.6g}"
        for x, (low, high) in zip(names, domains, strict=True)
    ]
    each = (", ".join(f"{v:4.0f}" for v in row) for row in 1e3 * C / size)
    rows = ",\n".join(f"{' ' * 12}[{row}]" for row in each)
    return [
        f"shares = np.array([{', '.join(shares)}])",
        "inside = np.clip(shares, 0.0, 1.0)",
        f"one, other = np.cos(np.pi * inside[..., None] * np.arange({len(C)}))",
        f"beyond = {np.sqrt(3.0) / law.places[2]:.6g} * np.abs(shares - inside)",
        "kept = np.prod((1.0 + beyond) * np.exp(-beyond), axis=0)",
        f"C = 1e-3 * np.array([\n{rows},\n        ])",
        'return (kept * np.einsum("nk,kl,nl->n", one, C, other),)',
    ]


def _table(learning: Learning, law: Law, k: int, x: str) -> str:
    """A curve without a formula as a table to be interpolated in, its largest value 1."""
    at, y = _curve(learning, law, k)
    knots = f"np.linspace({at[0]:.6g}, {at[-1]:.6g}, {len(at)})"
    values = [f"{v:.3f}" for v in y / max(float(np.abs(y).max()), 1e-300)]
    rows = [", ".join(values[i : i + 10]) for i in range(0, len(values), 10)]
    table = ",\n".join(f"{' ' * 12}{row}" for row in rows)
    return f"np.interp({x}, {knots}, [\n{table},\n        ])"
