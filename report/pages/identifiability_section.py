"""The section of a design page on what the touches can and cannot distinguish."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby

from matstd.artefact.compare import IdentifiabilityReport
from matstd.information.identifiability import (
    STRONG_CORRELATION,
    Degree,
    FreedomFamily,
    Resolution,
    ties,
)
from matstd.report.identifiability import (
    combination_words,
    family_words,
    gist,
    in_words,
    pair_words,
    reason_words,
    resolution_words,
    short,
)
from matstd.report.layout import Picture, Section, Table
from matstd.report.maps import draw_ties
from matstd.report.numbers import digits, shown
from matstd.report.pages.design_result import Design
from matstd.twin.machine import Chain, Link
from matstd.twin.units import DEG

CORRELATION = "correlation.png"

_DEGREES = (
    "Degrees over the whole travel of a linear axis, harmonics of a rotary one, that the touches "
    "determine to half of their expected size, with all lower ones and all other errors free; and "
    "the standard uncertainty of the last. Degree 1 is missing where a location error or the "
    "set-up has the same signature"
)
_ALTERNATIVES = (
    "Effect of measuring half of the touches in another way; each set-up has its own unknown "
    "place, each stylus its own unknown offset. Reach and travel are checked, collisions are not"
)
_RESOLVED = "{} combinations that these touches cannot distinguish, but others could"
_NEVER = (
    "{} combinations that no touch on a workpiece can distinguish. They keep their expected values "
    "by convention: the datum of a set-up, the preset of a tool and the zeros of the axes absorb "
    "them"
)
_CORRELATIONS = (
    "Correlations after the fit of the parameters in the largest groups; each group is framed. "
    "They follow from the touches and the stated error ranges alone and are the same for every "
    "machine."
)


def identifiability_sections(design: Design) -> list[Section]:
    """Condition and degrees; single errors, combinations, freedoms and correlations as files."""
    known = design.identifiability
    never = [f for f in known.freedoms if f.first.resolution is Resolution.NEVER]
    resolved = [f for f in known.freedoms if f not in never]
    words = (
        f"{gist(known)}. The data, rather than the expected errors of such a machine, determine "
        f"{digits(design.effective)} combinations; {len(known.alone)} machine errors are known "
        "individually. The other errors do not impair the prediction of the tool point, but no "
        "single one of them can be stated."
    )
    correlated, drawn = _ties(design)
    lists = [
        _conditions(known),
        _alternatives(known),
        _single_errors(known),
        _combinations(known),
        _freedoms(known, resolved, _RESOLVED.format(sum(f.count for f in resolved))),
        _freedoms(known, never, _NEVER.format(sum(f.count for f in never))),
        correlated,
    ]
    return [
        Section("What the touches can distinguish", sentences=[words], table=_degrees(known)),
        *(Section(table=replace(table, is_file=True)) for table in lists),
        Section(fold="Correlated parameters", is_for_screen=True, pictures=[drawn]),
    ]


def _size(value: float, unit: str) -> str:
    label, factor = shown(unit)
    return f"{digits(value / factor, 2)} {label}"


def _conditions(known: IdentifiabilityReport) -> Table:
    gauge = known.gauge
    found = {
        "columns scaled to length one": gauge.condition,
        "parameters in units of their expected sizes": gauge.condition_prior,
        "parameters in µm and µrad": gauge.condition_raw,
    }
    caption = "Condition number of the touches: largest over smallest visible singular value"
    rows = [[words, _rounded(value)] for words, value in found.items()]
    return Table(("scaling", "condition number"), rows, caption)


def _rounded(value: float) -> str:
    """A large number to two digits, `15 000`."""
    return f"{float(f'{value:.2g}'):,.0f}".replace(",", "\u202f")


def _with_minus(words: str) -> str:
    """Signs of an equation as they are set in print."""
    return words.replace("= - ", "= −").replace(" - ", " − ")


def _degrees(known: IdentifiabilityReport) -> Table:
    """A row for each axis, a cell for each component error."""
    by_symbol = {d.symbol: d for d in known.degrees}
    rows = []
    for axis in known.readings:
        link = known.chain.link(axis)
        what = "degrees" if link.kind == "linear" else "harmonics"
        touched = f"{_span(link, known.readings[axis])}\n{_span(link, link.range)}"
        cells = [_degree(by_symbol.get(f"E{letter}{axis}")) for letter in "XYZABC"]
        rows.append([f"{axis}, {what}", touched, *cells])
    ways = [f"{how} {letter}" for how in ("along", "about") for letter in "XYZ"]
    return Table(("axis", "touched,\nof a travel of", *ways), rows, _DEGREES)


def _span(link: Link, limits: Sequence[float]) -> str:
    unit, label = (1.0, "mm") if link.kind == "linear" else (DEG, "°")
    low, high = (f"{v / unit:.0f}" for v in limits)
    return f"{low} to {high} {label}"


def _degree(degree: Degree | None) -> str:
    """Degrees that are supported, and the uncertainty of the last."""
    if degree is None:
        return ""
    if not degree.supported:
        return "–"
    first, last = degree.supported[0], degree.supported[-1]
    which = f"{first}" if first == last else f"{first} to {last}"
    return f"{which}\n± {_size(degree.u, degree.unit)}"


def _single_errors(known: IdentifiabilityReport) -> Table:
    return Table.of(
        known.alone,
        {
            "error": lambda a: in_words(a.name, known.chain),
            "expected, standard deviation": lambda a: _size(a.expected, a.unit),
            "remaining standard uncertainty": lambda a: _size(a.u, a.unit),
        },
        f"{len(known.alone)} errors whose variance the touches reduce at least tenfold",
    )


def _combinations(known: IdentifiabilityReport) -> Table:
    names = [short(name) for name in known.model.names]
    units = [parameter.unit for _, parameter in known.model.parameters]
    return Table.of(
        known.combinations,
        {
            "combination": lambda c: _with_minus(
                combination_words(names, units, c.weights, c.importance)
            ),
            "standard uncertainty": lambda c: _size(c.u, c.unit),
            "expected over remaining": lambda c: digits(c.gain, 2),
        },
        f"{len(known.combinations)} combinations, the most certain first, that the touches "
        "determine better than the expected errors do, with unknown set-up and tool; "
        "scaled to the first error",
    )


def _by_cause(freedoms: Sequence[FreedomFamily], chain: Chain) -> Iterator[tuple[str, str, str]]:
    """Freedoms, one a line, with what causes them and what would resolve them."""

    def cause(family: FreedomFamily) -> tuple[str, str]:
        return resolution_words(family.first), reason_words(family.first)

    order = list(dict.fromkeys(map(cause, freedoms)))
    ranked = sorted(freedoms, key=lambda f: order.index(cause(f)))
    for (by, why), members in groupby(ranked, key=cause):
        yield "\n".join(_with_minus(family_words(f, chain)) for f in members), why, by


def _freedoms(
    known: IdentifiabilityReport, freedoms: Sequence[FreedomFamily], caption: str
) -> Table:
    rows = [list(row) for row in _by_cause(freedoms, known.chain)]
    return Table(("indistinguishable", "reason", "distinguished by"), rows, caption)


def _alternatives(known: IdentifiabilityReport) -> Table:
    rows = [
        [a.name, str(a.rank_gained), digits(a.variance_ratio)]
        if a.is_possible
        else [a.name, str(a.refusal), ""]
        for a in known.alternatives
    ]
    ratio = "variance of the predicted tool point\nrelative to as many touches as now"
    columns = ("second half measured with", "additional visible\ncombinations of errors", ratio)
    return Table(columns, rows, _ALTERNATIVES)


def _ties(design: Design) -> tuple[Table, Picture]:
    """Parameters that the touches correlate without confounding them."""
    fit = design.machines[0].fit
    found = ties(fit.covariance, [short(name) for name in fit.names])
    caption = (
        f"{len(found.pairs)} pairs of parameters that remain correlated beyond "
        f"{STRONG_CORRELATION} after the fit, in {len(found.groups)} groups; difference and sum "
        "are in units of their standard deviations"
    )
    rows = [[pair_words(pair, found.names)] for pair in found.pairs]
    return Table(("pair",), rows, caption), Picture(CORRELATION, _CORRELATIONS, draw_ties(found))
