"""The page of a diagnosis: verdict, the error falling, what was tried, what stays open."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from matstd.diagnosis.answer import Detectable, Diagnosis, Plan, Step, Verdict
from matstd.diagnosis.fit import file_unit
from matstd.report.effects import class_words, effect_cell, plan_words
from matstd.report.geometry import fault_sentences, geometry_section
from matstd.report.numbers import digits, unit_words
from matstd.report.pages.page import write_page
from matstd.report.pages.residual_section import (
    Picture,
    gross_rows,
    pattern_pictures,
    region_rows,
    residual_pictures,
    setting,
)
from matstd.report.pages.trend_section import trend_section
from matstd.report.plots import (
    draw_candidates,
    draw_effect,
    draw_fall,
    draw_form,
    draw_on_standard,
    draw_rivals,
    is_form,
    is_spread,
)
from matstd.report.style import series
from matstd.report.words import (
    remark_sentence,
    scanned_sentence,
    sizes,
    structure_words,
    values,
    verdict_sentence,
)
from matstd.twin.files import reading_columns
from matstd.twin.library import kinds, parse_effect
from matstd.twin.units import UM

PAGE = "report.html"
PICTURES = "pictures"

NEXT = 3
"""Effects that were told apart, but come next, that are listed."""

SAME = 0.1
"""Log odds below which two effects are the same as far as a picture can show."""

_PLANNED = 24


def write_diagnosis_page(
    result: Diagnosis, folder: str | Path, title: str, rng: np.random.Generator
) -> Path:
    """Draw the pictures of a diagnosis and write its page, which stands alone.

    Args:
        result: The diagnosis.
        folder: Where `report.html` and the folder `pictures` go.
        title: What was diagnosed: the name of the run file.
        rng: Shuffles residuals, to show what chance looks like.
    """
    folder, chain = Path(folder), result.run.touches.chain
    place = folder / PICTURES
    place.mkdir(parents=True, exist_ok=True)
    if len(result.steps) > 1:
        draw_fall(place / "fall.png", result)
    if result.candidates:
        draw_candidates(place / "candidates.png", result)
    write_page(
        folder / PAGE,
        "diagnose.html",
        place=place,
        title=title,
        result=result,
        sentence=verdict_sentence(result),
        faults=fault_sentences(result.faults),
        remarks=[remark_sentence(r) for r in result.remarks],
        where=region_rows(result.where),
        depends_on=[
            {"variable": d.variable, "words": structure_words(d.structure), "p": d.p_value}
            for d in result.depends_on
        ],
        is_bad=result.verdict in (Verdict.UNEXPLAINED, Verdict.UNDECIDED),
        um=UM,
        steps=[_step(step) for step in result.steps],
        effects=[_effect(result, i, place) for i in range(1, len(result.steps))],
        patterns=pattern_pictures(place, result.fit, result.left, rng),
        before=residual_pictures(place, "before", result.start),
        after=residual_pictures(place, "after", result.fit) if len(result.steps) > 1 else [],
        on_standard=_on_standard(result, place),
        geometry=geometry_section(result.run.touches, result.geometry),
        trend=trend_section(result.trend, place),
        detectable=_detectable(result.detectable),
        scanned=scanned_sentence(result.detectable),
        candidates=[(parse_effect(c.effect, chain), c) for c in result.candidates],
        plans=[_plan(p) for p in result.plans],
        gross=gross_rows(result.fit),
        **setting(result.run, result.fit),
    )
    return folder / PAGE


def _on_standard(result: Diagnosis, place: Path) -> list[Picture]:
    """The standard coloured by residual, before and after on one scale."""
    if not is_spread(result.run.touches):
        return []
    fits = [("starting model", result.start)]
    if len(result.steps) > 1:
        fits.append(("with what was added", result.fit))
    draw_on_standard(place / "on_standard.png", tuple(fits))
    return [Picture("on_standard.png", "Touched points in the frame of the standard, by residual.")]


def _step(step: Step) -> dict[str, Any]:
    """Row of the table of steps."""
    title, name = effect_cell(step) if step.effect is not None else ("starting model", "")
    return {
        "title": title,
        "name": name,
        "size": sizes(step, most=2) if step.effect is not None else "",
        "p": step.p_value if step.effect is not None else None,
        "rms": step.fit.rms / UM,
        "test_rms": step.fit.test_rms / UM,
        "chi2": step.fit.noise.chi2_ratio,
    }


def _effect(result: Diagnosis, i: int, place: Path) -> dict[str, Any]:
    """What is told of one added effect, with its pictures."""
    step = result.steps[i]
    assert step.effect is not None
    colour = series(i - 1)
    name = f"effect_{i}.png"
    form = is_form(result.fit, step.effect)
    if form:
        draw_form(place / name, result.fit, step.effect)
    else:
        draw_effect(place / name, result.fit, step.effect, colour)
    kind = next((k for k in kinds() if k.word == step.effect.kind), None)
    return {
        "effect": step.effect,
        "words": class_words(step),
        "picture": name,
        "caption": _FORM if form else _COURSE,
        "kind": kind,
        "values": values(step),
        "more": len(values(step)) < len(step.reported),
        "alike": len(step.confusion.rivals) if step.confusion else 0,
        "against": _against(step),
        "by_user": step.is_named,
        "rivals": _rivals(step, i, place, colour),
        "p": step.p_value,
    }


_COURSE = (
    "Left: what the run shows of this effect alone, with its fitted course. Right: the same "
    "touches once it is in the model. Dots: means with standard errors."
)
_FORM = (
    "Left: what the touches on this feature show of its form, on the fitted form. Right: the same "
    "touches once it is in the model."
)


def _against(step: Step) -> list[dict[str, Any]]:
    """Everything that explains the same touches, by the odds against it."""
    if step.confusion is None:
        return []
    rivals = [(r, True) for r in step.confusion.rivals]
    rivals += [(r, False) for r in step.confusion.told_apart[:NEXT]]
    return [
        {
            "effect": r.effect,
            "odds": odds(r.log_odds),
            "overlap": r.overlap,
            "is_confused": is_confused,
        }
        for r, is_confused in rivals
    ]


def odds(log_odds: float) -> str:
    """Odds of a natural logarithm as a reader sees them.

    Example:
        >>> odds(0.02), odds(2.3), odds(30.0)
        ('1 : 1', '10 : 1', '10^13 : 1')
    """
    ratio = math.exp(min(max(log_odds, 0.0), 700.0))
    if ratio < 1.05:
        return "1 : 1"
    if ratio < 1e4:
        return f"{digits(ratio, 2)} : 1"
    return f"10^{math.floor(math.log10(ratio))} : 1"


def _rivals(step: Step, i: int, place: Path, colour: str) -> str:
    """File of the picture of rivals, "" where there is nothing to see."""
    confusion = step.confusion
    others = (*confusion.rivals, *confusion.told_apart) if confusion is not None else ()
    if confusion is None or all(abs(r.log_odds) < SAME for r in others):
        return ""  # signatures that coincide make a picture of nothing
    draw_rivals(place / f"rivals_{i}.png", confusion, colour)
    return f"rivals_{i}.png"


def _detectable(found: Sequence[Detectable]) -> list[dict[str, Any]]:
    """Smallest detectable sizes by kind, each with its effects in order of size."""
    by_kind: dict[str, list[Detectable]] = {}
    for d in found:
        by_kind.setdefault(d.effect.kind, []).append(d)
    titles = {kind.word: kind.title for kind in kinds()}
    return [{"title": titles[k], **_kind_row(k, by_kind[k])} for k in sorted(by_kind)]


def _kind_row(kind: str, found: Sequence[Detectable]) -> dict[str, Any]:
    seen = sorted((d for d in found if d.largest is not None), key=lambda d: d.largest or 0.0)
    return {
        "kind": kind,
        "count": len(found),
        "best": _sized(seen[0]) if seen else None,
        "worst": _sized(seen[-1]) if len(seen) > 1 else None,
        "all": [_sized(d) for d in seen],
        "hidden": [d.effect for d in found if d.largest is None],
    }


def _sized(d: Detectable) -> dict[str, Any]:
    """Size of one effect in the unit of its file, and the deviation that it causes."""
    suffix, factor = file_unit(d.unit)
    return {
        "effect": d.effect,
        "size": (d.size or 0.0) / factor,
        "unit": unit_words(suffix),
        "largest": (d.largest or 0.0) / UM,
        "survives": d.survives,
    }


def _plan(plan: Plan) -> dict[str, Any]:
    """Table of the touches of a plan: where the axes go, and what is touched."""
    touches = plan.touches
    columns = reading_columns(touches.chain)
    axes = list(touches.chain.programmed_axes)
    rows = []
    for i in range(min(len(touches), _PLANNED)):
        cells = [f"{touches.reading(axis)[i] / columns[axis][1]:.3f}" for axis in axes]
        where = [str(touches.feature[i]), touches.setups[touches.setup[i]].name]
        rows.append([*where, *cells, *(f"{v:.3f}" for v in touches.point[i])])
    head = ["feature", "set-up", *(columns[a][0] for a in axes), "px_mm", "py_mm", "pz_mm"]
    return {"words": plan_words(plan), "head": head, "rows": rows, "separation": plan.separation}
