"""Pictures of a diagnosis: the error falling, rival effects, and each effect alone."""

from dataclasses import replace
from typing import Any

import numpy as np

from matstd.diagnosis.answer import Candidate, ConfusionClass, Diagnosis, Step
from matstd.diagnosis.fit import MIN_POSES, Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.residual import Partial, Seen, binned, partial
from matstd.report.effects import effect_cell, effect_title
from matstd.report.numbers import microns, noun, pose_word, shown
from matstd.report.plots.residual_pictures import kept
from matstd.report.style import (
    BLUE,
    DIVERGING,
    FAINT,
    INK,
    LINE,
    NEUTRAL,
    ORANGE,
    RED,
    SOFT,
    Figure,
    axis_of,
    figure,
    plain,
    robust_limit,
    series,
)
from matstd.twin.frames import Array, Mask
from matstd.twin.library import parse_effect
from matstd.twin.model import Effect, columns
from matstd.twin.numbers import rms
from matstd.twin.units import UM

MOST_BARS = 14  # rivals or candidates that get a bar

TEN = float(np.log(10.0))

SLOW, SCATTERED = 0.01, 0.3
"""Mean squared step over the variance, up to which a course is slow, and up to which it is one: a
cycle of a dozen touches is in between."""

ROW = 0.34  # height of a bar with two lines of words, inch

RATIO = 12.0
"""Between the largest and the smallest error of a fall, from which its scale is logarithmic."""


def draw_fall(diagnosis: Diagnosis) -> Figure:
    """Error of fitted and of held-out touches, step by step, against the noise."""
    fits = [(_step_words(s), s.fit) for s in diagnosis.steps]
    if diagnosis.laws is not None and diagnosis.laws.laws:
        fits.append(("with the\nlearnt law", diagnosis.laws.after))
    drawn = figure(3.9)
    ax = drawn.subplots()
    x = np.arange(len(fits))
    fitted = np.array([fit.rms for _, fit in fits]) / UM
    held = np.array([fit.test_rms for _, fit in fits]) / UM
    u = rms(diagnosis.run.u) / UM
    low, high = min(fitted.min(), held.min(), u), max(fitted.max(), held.max())
    _noise_lines(ax, diagnosis.fit, u)
    for y, colour, marker, word in (
        (held, ORANGE, "s", _held_words(diagnosis)),
        (fitted, BLUE, "o", "touches in the fit"),
    ):
        ax.step(x, y, where="mid", color=colour, lw=1.0, alpha=0.45)
        ax.plot(x, y, marker, ms=7, color=colour, label=word)
    for i in range(len(fits)):
        # the larger of the two is named above its mark, the smaller below
        up = held[i] >= fitted[i]
        _value(ax, i, held[i], up, ORANGE)
        _value(ax, i, fitted[i], not up, BLUE)
    if high > RATIO * low:
        ax.set(yscale="log", ylim=(0.55 * low, 1.8 * high))
    else:
        ax.set_ylim(0.0, 1.18 * high)
    ax.set_xlim(-0.5, max(len(fits) - 0.5, 1.5))
    ax.set_xticks(x, [words for words, _ in fits], fontsize=8.5)
    ax.set_ylabel("root mean square error in µm")
    plain(ax, "y")
    drawn.legend(fontsize=8.5, frameon=False, loc="outside upper center", ncols=4)
    return drawn


def _held_words(diagnosis: Diagnosis) -> str:
    if diagnosis.fit.test_rows.any():
        return "rows held out by the file"
    t = diagnosis.fit.run.touches
    poses = len(np.unique(np.column_stack([t.setup, t.pose])[diagnosis.fit.used], axis=0))
    return f"held out, one {pose_word(t) if poses >= MIN_POSES else 'block'} at a time"


def _step_words(step: Step) -> str:
    return (
        "starting\nmodel"
        if step.effect is None
        else "+ " + "\n".join(filter(None, effect_cell(step)))
    )


def _named(effect: Effect) -> str:
    """An effect beside its bar: title, below it its name."""
    title = effect_title(effect)
    return title if title == effect.name else f"{title}\n{effect.name}"


def _value(ax: Any, x: float, y: float, above: bool, colour: str) -> None:
    ax.annotate(
        f"{y:#.3g}".rstrip("."),
        (x, y),
        xytext=(0, 8 if above else -8),
        textcoords="offset points",
        ha="center",
        va="bottom" if above else "top",
        fontsize=8.5,
        color=colour,
        # the line of the noise passes behind
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 0.6},
    )


def _beside(ax: Any, x: float, y: float, points: float, text: str) -> None:
    """Small words to the right of the end of a bar."""
    at, style = (max(x, 0.0), y), {"va": "center", "fontsize": 7.5, "color": SOFT}
    ax.annotate(text, at, xytext=(points, 0.0), textcoords="offset points", **style)


def _noise_lines(ax: Any, fit: Fit, u: float) -> None:
    """Stated noise, and the estimated one where that differs."""
    ax.axhline(u, color=INK, lw=1.1, label=f"stated noise, {microns(u * UM)}")
    if fit.noise.is_wrongly_stated:
        found = u * fit.noise.factor
        ax.axhline(
            found, color=INK, lw=1.1, ls="--", label=f"residual scatter, {microns(found * UM)}"
        )


def draw_candidates(diagnosis: Diagnosis) -> Figure:
    """Evidence of library effects, each added alone to the starting model.

    A found effect and those not distinguished from it have one colour.
    """
    shown = [c for c in diagnosis.candidates if np.isfinite(c.log_odds)][:MOST_BARS]
    drawn = figure(1.3 + ROW * max(len(shown), 3))
    ax = drawn.subplots()
    odds = np.array([c.log_odds for c in shown]) / TEN
    y = np.arange(len(shown))[::-1]
    ax.barh(y, odds, 0.72, color=[_class_colour(diagnosis, c) for c in shown])
    ax.axvline(0.0, color=INK, lw=0.9)
    for at, value, candidate in zip(y, odds, shown, strict=True):
        _beside(ax, value, at, 4.0, f"held-out {candidate.test_rms / UM:.3g} µm")
    chain = diagnosis.run.touches.chain
    ax.set_yticks(y, [_named(parse_effect(c.effect, chain)) for c in shown])
    ax.set_xlabel("evidence for the single effect: powers of ten of the odds against no effect")
    ax.margins(x=0.14)
    ax.set_ylim(-0.7, len(shown) - 0.3)
    plain(ax, "x")
    _class_legend(drawn, diagnosis)
    return drawn


def _classes(diagnosis: Diagnosis) -> list[tuple[Effect, tuple[str, ...], str]]:
    """Every found effect with the names not distinguished from it, and its colour."""
    out = []
    for k, step in enumerate(diagnosis.steps[1:]):
        if step.effect is not None:
            rivals = step.confusion.rivals if step.confusion else ()
            names = (step.effect.name, *(r.effect.name for r in rivals))
            out.append((step.effect, names, series(k)))
    return out


def _class_colour(diagnosis: Diagnosis, candidate: Candidate) -> str:
    """Colour of the found effect that a candidate is, or is not distinguished from."""
    return next((c for _, names, c in _classes(diagnosis) if candidate.effect in names), NEUTRAL)


def _class_legend(drawn: Any, diagnosis: Diagnosis) -> None:
    from matplotlib.patches import Patch

    classes = _classes(diagnosis)
    handles = [
        Patch(
            color=colour,
            label=effect_title(effect) + (" and indistinguishable effects" if names[1:] else ""),
        )
        for effect, names, colour in classes
    ]
    if handles:
        handles.append(Patch(color=NEUTRAL, label="other effects"))
        drawn.legend(
            handles=handles, fontsize=8, frameon=False, loc="outside lower center", ncols=2
        )


def draw_rivals(confusion: ConfusionClass, colour: str = BLUE) -> Figure:
    """A found effect against everything that explains the same touches, by its odds."""
    apart = confusion.distinguished[: max(2, MOST_BARS - len(confusion.rivals))]
    rows = [*confusion.rivals[:MOST_BARS], *apart]
    names = [_named(e) for e in (confusion.effect, *(r.effect for r in rows))]
    behind = np.array([0.0, *(max(r.log_odds, -POLICY.log_odds_alike) for r in rows)]) / TEN
    alike = 1 + min(len(confusion.rivals), MOST_BARS)
    drawn = figure(1.1 + ROW * len(names))
    ax = drawn.subplots()
    y = np.arange(len(names))[::-1]
    ax.axvspan(
        -POLICY.log_odds_alike / TEN, POLICY.log_odds_alike / TEN, color=LINE, alpha=0.45, lw=0
    )
    ax.axvline(0.0, color=INK, lw=0.9)
    colours = np.array([colour] * alike + [SOFT] * (len(names) - alike))
    ax.scatter(behind, y, s=48, c=colours, zorder=3)
    ax.hlines(y, 0.0, behind, color=colours, lw=1.6)
    for at, value, rival in zip(y[1:], behind[1:], rows, strict=True):
        _beside(ax, value, at, 7.0, f"overlap {100.0 * rival.overlap:.1f} %")
    ax.set_yticks(y, names)
    ax.set_xlabel(
        "odds in favour of the first, powers of ten (shaded: below 1 : 100, not distinguished)"
    )
    ax.margins(x=0.12)
    ax.set_ylim(-0.7, len(names) - 0.3)
    plain(ax, "x")
    return drawn


def draw_effect(fit: Fit, effect: Effect, colour: str = BLUE) -> Figure:
    """One effect in a run: its course, the touches it explains, and their residuals."""
    found, variable, quantity = shown_partial(partial(fit, effect))
    drawn = figure(3.9)
    left, right = drawn.subplots(1, 2, width_ratios=(1.35, 1.0))
    tested = np.ones(len(found.rows), dtype=bool)
    tested[: int(fit.used.sum())] = False
    for ax, y, title in (
        (left, found.observed, "residual plus effect"),
        (right, found.observed - found.explained, "residual"),
    ):
        _touches(ax, found, y, tested)
        ax.set_title(title, fontsize=9.5, loc="left", color=INK)
        ax.set_xlabel(variable or f"explained: {quantity}", fontsize=9)
        plain(ax)
    _course(left, found, effect, colour)
    right.axhline(0.0, color=colour, lw=1.6, zorder=4)
    low, high = _limits(found)
    left.set_ylim(low, high)
    right.set_ylim(0.5 * (low - high), 0.5 * (high - low))  # about zero, as large a scale
    left.set_ylabel(quantity)
    left.legend(fontsize=8, framealpha=0.85, edgecolor="none")
    return drawn


def shown_partial(found: Partial) -> tuple[Partial, str, str]:
    """Partial residuals in the units of a picture, and the labels of its axes.

    Returns:
        The residuals; what they are drawn over, "" where it is no function of one variable; what is
        drawn.
    """
    unit, factor = shown("rad" if found.drawn.is_angular else "mm")
    symbol = found.drawn.symbol
    words = {Seen.SHIFT: f"{found.drawn.seen.value} in {symbol}", Seen.ERROR: symbol}
    quantity = f"{words.get(found.drawn.seen, found.drawn.seen.value)}, {unit}"
    variable, x = axis_of(found.driver.column, found.x)
    if not variable:
        x = found.x / factor
    elif found.driver.period:
        unit = "°" if found.driver.column.endswith("_deg") else " mm"
        variable = f"{noun(found.driver.column)} within a period of {found.driver.period:.4g}{unit}"
    scaled = replace(
        found,
        x=x,
        explained=found.explained / factor,
        observed=found.observed / factor,
        weight=found.weight * factor**2,
    )
    return scaled, variable, quantity


def _limits(found: Partial) -> tuple[float, float]:
    """Ends of a scale that holds the course and all but a few touches and residuals."""
    low, high = np.quantile(found.observed[found.shown], (0.003, 0.997))
    low, high = min(low, float(found.explained.min())), max(high, float(found.explained.max()))
    spread = 2.0 * float(np.quantile(np.abs(found.observed - found.explained)[found.shown], 0.99))
    margin = max(0.06 * (high - low), 0.5 * (spread - (high - low)))
    return float(low - margin), float(high + margin)


def _course(ax: Any, found: Partial, effect: Effect, colour: str) -> None:
    """What the effect explains, as a line where it is a function, else as marks."""
    if found.way.any():
        for way, style, word in ((1, "-", "forward"), (-1, "--", "backward")):
            rows = np.flatnonzero(found.way == way)
            rows = rows[np.argsort(found.x[rows], kind="stable")]
            label = f"{effect_title(effect)}, {word}"
            ax.plot(found.x[rows], found.explained[rows], style, color=colour, lw=1.6, label=label)
        return
    order = np.argsort(found.x, kind="stable")
    x, y = found.x[order], found.explained[order]
    if not found.driver.column:
        ax.plot(x[[0, -1]], x[[0, -1]], color=colour, lw=1.8, zorder=4, label=effect_title(effect))
        return
    if len(np.unique(x)) > 12 and _roughness(found) < SCATTERED:
        ax.plot(x, y, color=colour, lw=1.8, zorder=4, label=effect_title(effect))
    else:
        ax.plot(x, y, "_", ms=7, mew=1.6, color=colour, zorder=4, label=effect_title(effect))


def _roughness(found: Partial) -> float:
    """Mean squared step of the course from touch to touch over its variance; 2 where it is none."""
    y = found.explained[np.argsort(found.x, kind="stable")]
    return float(np.mean(np.diff(y) ** 2)) / max(float(np.var(y)), 1e-30)


def _touches(ax: Any, found: Partial, y: Array, tested: Mask) -> None:
    """Touches as points, held-out ones apart, and means with standard errors."""
    for rows, colour, word in (
        (found.shown[~tested[found.shown]], FAINT, "touches"),
        (found.shown[tested[found.shown]], "#d9b26a", "touches held out"),
    ):
        if len(rows):
            part = rows[kept(len(rows))]
            ax.plot(found.x[part], y[part], ".", ms=2.4, color=colour, alpha=0.7, label=word)
    ways = [found.way == way for way in np.unique(found.way)]
    for which, colour in [(p & w, c) for p, c in ((~tested, INK), (tested, RED)) for w in ways]:
        if which.sum() > 1:
            most = 24 if _roughness(found) < SLOW else 72
            x, mean, error = binned(found.x[which], y[which], found.weight[which], most)
            style = {"ms": 4.2, "lw": 1.2, "color": colour, "zorder": 5}
            ax.errorbar(x, mean, error, fmt="o", **style)
    ax.axhline(0.0, color=SOFT, lw=0.8)


LEVELS = 15


def is_form(fit: Fit, effect: Effect) -> bool:
    """Whether an effect is the form of one feature, with touches enough to draw a map of it."""
    return effect.kind == "artefact-form" and int(_on_patch(fit, effect).sum()) > 3


def draw_form(fit: Fit, effect: Effect) -> Figure:
    """Form of a patch: touches on the fitted form, and their residuals."""
    rows = _on_patch(fit, effect)
    touches = fit.run.touches
    explained = (columns([effect], touches) @ fit.theta[fit.of_effect(effect.name)])[rows] / UM
    left_over = fit.residual[rows] / UM
    place = _flat(touches.point[rows])
    drawn = figure(3.9)
    axes = drawn.subplots(1, 2, sharex=True, sharey=True)
    limit = robust_limit(explained + left_over, 0.98)
    style: dict[str, Any] = {"cmap": DIVERGING, "vmin": -limit, "vmax": limit}
    if np.linalg.matrix_rank(place - place.mean(axis=0)) == 2:
        levels = np.linspace(-limit, limit, LEVELS)
        axes[0].tricontourf(*place.T, explained, levels=levels, extend="both", alpha=0.75, **style)
    for ax, values, title in (
        (axes[0], explained + left_over, "residual plus effect, on the fitted form"),
        (axes[1], left_over, "the same touches with the effect in the model"),
    ):
        marks = ax.scatter(*place.T, c=values, s=34.0, edgecolors=INK, linewidths=0.5, **style)
        ax.set_title(title, fontsize=9.5, loc="left", color=INK)
        ax.set(xlabel="along the patch in mm", aspect="equal")
        ax.margins(0.06)
        plain(ax)
    axes[0].set_ylabel("across the patch in mm")
    bar = drawn.colorbar(marks, ax=list(axes), pad=0.02, shrink=0.9, extend="both")
    bar.set_label("deviation along the normal, µm", fontsize=8.5)
    return drawn


def _on_patch(fit: Fit, effect: Effect) -> Mask:
    """Touches in use that the effect moves, (N,)."""
    moved = np.any(columns([effect], fit.run.touches) != 0.0, axis=1)
    return np.asarray(moved & fit.used)


def _flat(point: Array) -> Array:
    """Places of points (M, 3) in the plane of their two longest directions, (M, 2), mm."""
    centred = point - point.mean(axis=0)
    return np.asarray(centred @ np.linalg.svd(centred, full_matrices=False)[2][:2].T)
