"""The page of laws that were learnt: the law, its picture, its rivals, its errors elsewhere."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from matstd.diagnosis.laws import (
    Estimate,
    Learning,
    LearntLaw,
    SecondRun,
    amplitudes,
    places,
    surface_of,
)
from matstd.diagnosis.next_visit import VisitPlan
from matstd.report.laws.curves import MIN_LEVER, LawCurve, axis_label, law_curve
from matstd.report.laws.law_words import (
    amplitude_words,
    carrier_words,
    formula_words,
    held_out_sentence,
    instead_sentence,
    law_sentence,
    library_sentence,
    limits_sentences,
    no_law_sentence,
    place_words,
    rival_sentence,
    rivals_sentence,
    variable_words,
)
from matstd.report.laws.looks import looks_like
from matstd.report.laws.run_words import second_run_sentence
from matstd.report.laws.visit_words import visit_section
from matstd.report.layout import KeyFigure, LiveView, Page, Picture, Section, Table, write_page
from matstd.report.numbers import digits, microns, odds_words, sentence
from matstd.report.style import (
    BLUE,
    DIVERGING,
    FAINT,
    INK,
    NEUTRAL,
    ORANGE,
    Figure,
    figure,
    plain,
    robust_limit,
)
from matstd.twin.frames import Mask
from matstd.twin.laws import Law
from matstd.twin.units import UM, URAD

SURFACE_POINTS = 80  # points of either variable at which a surface is drawn

_WHAT = (
    "A law states what the remainder depends on and how it looks. It has no cause: that is for you "
    "to find. It was chosen among all carriers, variables and shapes by the evidence of the run, "
    "with a charge for all that was tried, and is kept because it predicts touches that were left "
    "out better than the model alone."
)
_ALIKE = (
    "Laws that the run cannot distinguish form a class; predictions average over it with these "
    "shares. A run in which they differ decides: other axis positions for other carriers, another "
    "course of time for a temperature."
)
_CURVE = (
    "The law with twice its uncertainty (of a curve without a formula that of its form beside a "
    "parabola, which geometry takes up), and the touches with the law put back, over their levers "
    "on the carrier. Touches with a small lever are not drawn."
)
_SURFACE = (
    "The touches with the law put back, over their levers on the carrier; the law; and the "
    "standard uncertainty of its form beside a surface of second degree, which geometry takes up. "
    "Touches with a small lever are not drawn."
)
_NOTHING = (
    "What remains follows from nothing that the run recorded in any form that was tried. The model "
    "of the starting effects stays as it is."
)
_MEANS = (
    "The law predicts touches that were not fitted. It is no cause: it holds where it was learnt, "
    "and a named effect with the same form may replace it."
)
_NEXT = (
    "Try the law on another run: `matstd compare RUN.csv --model model.toml`; only then compensate "
    "with it. Give it its name in effect.py, and fit it anew by that name: `matstd diagnose "
    "RUN.csv --effects effect.py --add NAME`."
)
_VISIT = (
    "To distinguish the law from its rivals, probe `next_visit.csv` and learn from both runs: "
    "`matstd learn {runs} visit.csv`."
)
_WITHOUT = "Record what could cause it (a temperature, a load, a speed) and probe again."
_FOOT = (
    "Uncertainties are standard uncertainties (k = 1) of the fit with all parameters of the law; "
    "of an edge that of the gap between touches. That another law might be true is not in them."
)


def write_law_page(
    learning: Learning,
    folder: str | Path,
    title: str,
    visit: VisitPlan,
    second: SecondRun | None,
    live: LiveView | None = None,
    remarks: Sequence[str] = (),
) -> None:
    """Write `report.html` and its pictures into a folder; in `live` the laws are switched."""
    noted = [Section("Remarks on the run", items=list(remarks))] if remarks else []
    lead, means, what_next = _head(learning, visit, title)
    page = Page(
        heading=f"What the model leaves of {title}",
        lead=lead,
        means=means,
        next=what_next,
        key=_key(learning, second),
        sections=[*law_sections(learning, visit, second), *noted],
        foot=[_FOOT],
        live=live,
    )
    write_page(Path(folder) / "report.html", page)


def law_sections(
    learning: Learning, visit: VisitPlan | None, second: SecondRun | None = None
) -> list[Section]:
    """What was learnt: every law with picture and rivals, the next visit, the error elsewhere."""
    limits = limits_sentences(learning)
    if not learning.laws:
        return [Section(sentences=[no_law_sentence(learning), *limits])]
    instead = instead_sentence(learning)
    out = [Section(sentences=[*([f"**{instead}**"] if instead else []), _WHAT, *limits])]
    for i, one in enumerate(learning.laws, start=1):
        out += _law_sections(learning, one, i)
    return [*out, *(visit_section(visit) if visit else []), _held_out(learning, second)]


def _head(learning: Learning, visit: VisitPlan, title: str) -> tuple[str, str, str]:
    """What was learnt, what it means, and what to do next."""
    if not learning.laws:
        return no_law_sentence(learning), _NOTHING, _WITHOUT
    lead = " ".join(sentence(law_sentence(learning, one)) for one in learning.laws)
    return lead, _MEANS, _NEXT if visit.touches is None else f"{_VISIT.format(runs=title)} {_NEXT}"


def _key(learning: Learning, second: SecondRun | None) -> list[KeyFigure]:
    first = learning.held_out[0] if learning.held_out else None
    out = []
    if first is not None:
        size = f"{digits(first.before / UM)} → {microns(first.after)}"
        out.append(KeyFigure(size, "poses left out, without and with the law", "good"))
    if second is not None and second.learnt != second.without:
        size = f"{digits(second.without / UM)} → {microns(second.learnt)}"
        out.append(KeyFigure(size, "second run", "good" if second.is_better else "bad"))
    chi2 = learning.before.noise.chi2_ratio, learning.after.noise.chi2_ratio
    out.append(
        KeyFigure(f"{digits(chi2[0])} → {digits(chi2[1])}", "chi-square per degree of freedom")
    )
    stated = float(np.median(learning.before.run.u))
    out.append(KeyFigure(microns(stated), "stated noise"))
    out.append(KeyFigure(str(len(learning.before.run)), "touches"))
    return out


def _law_sections(learning: Learning, one: LearntLaw, number: int) -> list[Section]:
    law = one.law
    several = len(learning.laws) > 1
    numbers = [_row(a, amplitude_words(law, a)) for a in amplitudes(learning, law)][:6]
    if law.is_curve_alone:
        numbers = []
    numbers += [_row(p, place_words(p)) for p in places(learning, law)]
    caption = _SURFACE if law.is_surface else _CURVE
    picture = Picture(f"pictures/law_{number}.png", caption, draw_law(learning, law))
    table = Table(("parameter", "value"), numbers, "Numbers of the law")
    said = [looks_like(law), rival_sentence(one), library_sentence(one), rivals_sentence(one)]
    first = [f"**{formula_words(law)}**", *filter(None, said)]
    return [
        Section(
            f"Law {number}" if several else "The law",
            sentences=first,
            pictures=[picture],
            table=table,
        ),
        _rivals(learning, one),
    ]


def _row(one: Estimate, words: str) -> list[str]:
    value = words.removeprefix(f"{one.name} ")
    return [one.name, value if one.u is not None else f"{value} (fixed)"]


def _rivals(learning: Learning, one: LearntLaw) -> Section:
    members = {law.name: share for law, share in one.members(learning.policy)}
    shown = [(one.law, 0.0), *((r.law, r.log_odds) for r in one.rivals)]
    rows = [
        [
            formula_words(law),
            carrier_words(law.carrier),
            ", ".join(variable_words(driver) for driver in law.drivers),
            "–" if i == 0 else odds_words(odds),
            f"{100 * members[law.name]:.0f} %" if law.name in members else "",
        ]
        for i, (law, odds) in enumerate(shown[: learning.policy.most_rivals + 1])
    ]
    if one.library is not None and one.library.effect.name in members:
        name, odds = one.library.effect.name, odds_words(one.library_odds)
        rows.append([name, "the library", "", odds, f"{100 * members[name]:.0f} %"])
    columns = ("formula", "carrier", "variables", "odds against it", "share of predictions")
    return Section("Rivals", sentences=[_ALIKE], table=Table(columns, rows, best=[0]), is_part=True)


def _held_out(learning: Learning, second: SecondRun | None) -> Section:
    words = {"poses": "table poses", "times": "stretches of time"}
    rows: list[Sequence[str]] = [
        [f"blocks of {words.get(h.what, h.what)}", microns(h.before), microns(h.after)]
        for h in learning.held_out
    ]
    notes = []
    if second is not None:
        rows.append([f"second run, {second.touches} touches", microns(second.without),
                     microns(second.learnt)])  # fmt: skip
        if second.clocked is not None:
            rows.append(["the same, with all laws",
                         microns(second.without), microns(second.clocked)])  # fmt: skip
        notes = [second_run_sentence(second)]
    caption = "Error of touches that were left out, root mean square"
    return Section(
        "Error elsewhere",
        sentences=[held_out_sentence(learning)],
        table=Table(("left out", "without the law", "with it"), rows, caption),
        pictures=[
            Picture(
                "pictures/before_after.png",
                "Residual over the variables of the law, without it (above) and with it (below).",
                draw_before_after(learning),
            )
        ],
        notes=notes,
    )


def draw_law(learning: Learning, law: Law) -> Figure:
    """The law over each of its variables, with ± 2 u, and the touches with the law put back.

    A touch feels the carrier by a lever: its residual with the law put back is divided by it.
    """
    if law.is_surface:
        return _draw_surface(learning, law)
    drawn = figure(3.4)
    every = np.atleast_1d(drawn.subplots(1, len(law.drivers)))
    for ax, driver in zip(every, law.drivers, strict=True):
        _panel(ax, law_curve(learning, law, driver), learning.after.used)
    unit = "µrad" if law.carrier.is_angular else "µm"
    every[0].set_ylabel(f"{law.carrier.name} in {unit}")
    every[0].legend(fontsize=8, frameon=False)
    return drawn


def _draw_surface(learning: Learning, law: Law) -> Figure:
    """A law over two variables: the touches with it put back, the law, and its uncertainty."""
    fit = learning.after
    values = [driver.values(fit.run.touches) for driver in law.drivers]
    axes_of = [axis_label(d, v[fit.used]) for d, v in zip(law.drivers, values, strict=True)]
    lines = [np.linspace(v[fit.used].min(), v[fit.used].max(), SURFACE_POINTS) for v in values]
    x, y = (v.ravel() for v in np.meshgrid(*lines))
    scale, unit = (URAD, "µrad") if law.carrier.is_angular else (UM, "µm")
    value, u = (v.reshape(SURFACE_POINTS, -1) / scale for v in surface_of(learning, law, x, y))
    at_touches = surface_of(learning, law, *values)[0] / scale
    lever = law.carrier.columns(fit.run.touches)[:, 0]
    seen = fit.used & (np.abs(lever) > MIN_LEVER * np.abs(lever).max())
    touched = at_touches[seen] + fit.residual[seen] / lever[seen] / scale
    limit = float(np.abs(at_touches[fit.used]).max())
    style: dict[str, Any] = {"cmap": DIVERGING, "vmin": -limit, "vmax": limit}
    x, y = (v / per for v, (_, per) in zip(lines, axes_of, strict=True))
    drawn = figure(3.6)
    panels = drawn.subplots(1, 3, sharex=True, sharey=True)
    points = [v[seen] / per for v, (_, per) in zip(values, axes_of, strict=True)]
    panels[0].scatter(*points, c=touched, s=9.0, **style)
    law_map = panels[1].pcolormesh(x, y, value, shading="gouraud", **style)
    u_map = panels[2].pcolormesh(x, y, u, shading="gouraud", cmap="viridis", vmin=0.0)
    titles = "touches, law put back", "law", "its standard uncertainty"
    for ax, title in zip(panels, titles, strict=True):
        ax.set_title(title, fontsize=9.5, loc="left", color=INK)
        ax.set_xlabel(axes_of[0][0])
        plain(ax)
    panels[0].set_ylabel(axes_of[1][0])
    drawn.colorbar(law_map, ax=list(panels[:2]), pad=0.02).set_label(
        f"{law.carrier.name} in {unit}"
    )
    drawn.colorbar(u_map, ax=panels[2], pad=0.04).set_label(f"u in {unit}")
    return drawn


def _panel(ax: Any, curve: LawCurve, used: Mask) -> None:
    """A law over one of its variables."""
    seen = used & np.isfinite(curve.put_back)
    points = curve.put_back[seen]
    ax.plot(curve.touch_x[seen], points, ".", ms=2.5, color=FAINT, label="touches")
    low, high = curve.value - 2.0 * curve.u, curve.value + 2.0 * curve.u
    ax.fill_between(curve.x, low, high, color=BLUE, alpha=0.2, lw=0, label="± 2 u")
    ax.plot(curve.x, curve.value, color=BLUE, lw=1.6, label="law")
    limit = 1.4 * max(robust_limit(points), float(np.abs(curve.value).max()))
    ax.set_ylim(-limit, limit)
    ax.axhline(0.0, color=NEUTRAL, lw=0.7)
    ax.set_xlabel(curve.label)
    plain(ax)


def draw_before_after(learning: Learning) -> Figure:
    """Residual over every variable of the laws, without and with them, on one scale."""
    drivers = list(dict.fromkeys(d for one in learning.laws for d in one.law.drivers))[:3]
    drawn = figure(4.2)
    axes = drawn.subplots(2, len(drivers), sharey=True, squeeze=False)
    limit = robust_limit(learning.before.residual[learning.before.used] / UM, 0.995)
    pairs = ((learning.before, "without the law", ORANGE), (learning.after, "with the law", BLUE))
    for row, (fit, words, colour) in zip(axes, pairs, strict=True):
        for ax, driver in zip(row, drivers, strict=True):
            x = driver.values(fit.run.touches)[fit.used]
            label, per = axis_label(driver, x)
            shown = np.clip(fit.residual[fit.used] / UM, -limit, limit)
            ax.plot(x / per, shown, ".", ms=2.2, color=colour)
            ax.axhline(0.0, color=INK, lw=0.6)
            ax.set_xlabel(label)
            plain(ax)
        row[0].set_ylabel(f"residual in µm,\n{words}")
    return drawn
