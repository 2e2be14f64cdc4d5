"""What a user should know about a run besides the verdict, one clear line each."""

import numpy as np

from diagnosis.fit import MIN_POSES, Fit
from diagnosis.mixed_units import mixed_units
from twin.units import UM

FEW_DOF = 30.0
"""Below so many degrees of freedom only large effects can be seen."""

DOUBTFUL = 2.0
"""Error of held-out touches over the stated noise from which few touches leave all open."""

LISTED = 20
"""Gross errors whose lines are told."""


def remarks(fit: Fit) -> tuple[str, ...]:
    """Everything noteworthy in a fit: units, what the reader of the file noticed, the rest."""
    units = mixed_units(fit)
    out = [*units, *fit.run.remarks, *_memory(fit), *_touches(fit)]
    out += ([] if units else _noise(fit)) + _gross(fit)
    if fit.widened > 1.0:
        out.append(
            f"the machine's errors are about {fit.widened:.1f} times their stated distributions; "
            "the prior was widened by that"
        )
    return tuple(out)


def _touches(fit: Fit) -> list[str]:
    """Too few touches or poses, and what is still possible."""
    out = []
    n, p = int(fit.used.sum()), len(fit.parameters)
    if n < p:
        out.append(
            f"{n} touches for {p} parameters: the prior decides the rest; single parameters are "
            "not known, only what they do together where it was probed"
        )
    if fit.solution.dof < FEW_DOF:
        out.append(
            f"{fit.solution.dof:.0f} degrees of freedom are left for the noise: only large effects "
            "can be seen; the stated uncertainty is leant on"
        )
        stated = float(np.sqrt(np.mean(fit.run.u**2)))
        if fit.freed_rms > DOUBTFUL * stated:
            out.append(
                f"the error of held-out touches is {fit.freed_rms / stated:.1f} times the stated "
                "noise, with too few touches to say whether anything is missing: probe more"
            )
    t = fit.run.touches
    poses = len(np.unique(np.column_stack([t.setup, t.pose])[fit.used], axis=0))
    if poses < MIN_POSES:
        out.append(
            f"{poses} table pose{'s' if poses > 1 else ''} only: errors of the rotary axes "
            f"{'can hardly' if poses > 1 else 'cannot'} be seen, and touches are held out in "
            "blocks instead of by pose"
        )
    return out


def memory_words(fit: Fit) -> str:
    """What the noise remembers, `correlation 0.82 from touch to touch`; "" for white noise."""
    memory = fit.memory
    if memory is None:
        return ""
    place = " at one place" if memory.by_place else ""
    over = f"over {memory.step:.3g} s" if memory.step else "from touch to touch"
    return f"correlation {memory.correlation:.2f} {over}{place}"


def _memory(fit: Fit) -> list[str]:
    """Noise that remembers, or a residual that is slow."""
    if fit.memory is None:
        return []
    rows = int(fit.used.sum())
    count = f"{rows} touches count as {rows / fit.memory.per_independent:.0f} independent ones"
    if fit.memory.is_filtered:
        return [f"the noise remembers, {memory_words(fit)}: of whatever is slow {count}"]
    return [
        f"what is left is slow, {memory_words(fit)}: in probabilities and uncertainties {count}"
    ]


def _noise(fit: Fit) -> list[str]:
    """Noise that is not what the file states."""
    noise = fit.noise
    u = float(np.median(fit.run.u)) / UM
    if noise.replicates is not None and noise.replicates_dof >= 10:
        ratio = noise.factor / noise.replicates
        if ratio > 1.0 + 3.0 * (0.5 / noise.replicates_dof) ** 0.5:
            return [
                f"residuals are {ratio:.2f} times as large as the scatter of {noise.replicates_dof}"
                " replicates: the model lacks something"
            ]
    if noise.is_wrongly_stated:
        return [
            f"touches scatter by {noise.factor * u:.2f} µm about the model; {u:.2f} µm is stated"
        ]
    return []


def _gross(fit: Fit) -> list[str]:
    """Touches that were left out."""
    gross = fit.gross
    if gross.too_many:
        return [
            "more touches stand out than accidents can explain: all were kept, and the residual "
            "is treated as structure"
        ]
    rows = np.flatnonzero(gross.rows)
    if len(rows) == 0:
        return []
    rows = rows[np.argsort(-np.abs(gross.score[rows]))]
    size = fit.residual[rows[np.argmax(np.abs(fit.residual[rows]))]] / UM
    side = "outside" if size > 0 else "inside"
    lines = ", ".join(str(line) for line in fit.run.line[rows[:LISTED]])
    more = f" and {len(rows) - LISTED} more" if len(rows) > LISTED else ""
    return [
        f"{len(rows)} gross error{'s were' if len(rows) > 1 else ' was'} left out, "
        f"{'the largest ' if len(rows) > 1 else ''}{abs(size):.1f} µm {side} what the other "
        "touches predict: "
        f"line{'s' if len(rows) > 1 else ''} {lines}{more}"
    ]
