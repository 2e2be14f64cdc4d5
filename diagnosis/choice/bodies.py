"""Bodies that follow one drive at once and with two time constants, beside another drive.

What is heated at one end and held at the other has a fast and a slow way to settle. A search that
takes one effect at a time seldom finds both lags, since each alone does badly; there are few enough
of such bodies to try them all. Without them a model of one record of a printer's frame predicts the
next one to 12.9 instead of 6.9 µm.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from matstd.diagnosis.evidence import (
    EffectSet,
    ScaledEffect,
    log_evidence,
    projected,
    tuned_variants,
)
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import GrossErrors
from matstd.diagnosis.search import DiagnosisTask, refined_set
from matstd.twin.effects import repeat
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import Chain, Family, Symbol
from matstd.twin.model import Effect, moving_axes
from matstd.twin.record import Touches
from matstd.twin.thermal import ThermalLag, drives, follower, is_speed

MIN_CORRELATION_ALIKE = 0.999
"""Correlation from which two component errors act alike at the touches of a run."""

PRIOR_FACTOR = 16.0
"""Factor on the usual size of every effect of a body. A fast and a slow effect that share what they
explain are each larger than their sum."""

REFINEMENT_ROUNDS = 3
"""Turns in which the time constants of all bodies are refined beside one another."""


@dataclass(frozen=True, slots=True)
class _Family:
    """All that one component error may follow."""

    effects: tuple[Effect, ...]  # at once and at every time constant
    at_once: dict[str, int]  # number of the effect at once, by drive; the speed has none
    lags: dict[str, IntArray]  # numbers of the lags, by drive


def bodies(task: DiagnosisTask, gross: GrossErrors) -> tuple[ScaledEffect, ...]:
    """For every distinguishable component error the body that explains it best, if any."""
    complement = task.space(task.fit_found((), gross))
    touches = complement.touches
    chosen: list[ScaledEffect] = []
    for symbol in carriers(touches):
        base = EffectSet(complement, projected(complement, chosen))
        effects = _best(base, _family(symbol, touches))
        chosen += [ScaledEffect(e, PRIOR_FACTOR) for e in effects]
    return tuple(refined_set(complement, chosen, REFINEMENT_ROUNDS)) if chosen else ()


def carriers(touches: Touches) -> Iterator[Symbol]:
    """Component errors of the axis next to the tool among those that moved, else among all, that
    the touches see, one of each that act alike.
    """  # noqa: D205
    chain: Chain = touches.chain
    axis = (moving_axes(touches) or chain.axes)[-1]
    seen: list[Array] = []
    for symbol in chain.symbols:
        if symbol.family is not Family.COMPONENT or symbol.link != axis:
            continue
        part = touches.signature.twist[:, chain.link_index(axis), symbol.component]
        size = float(np.linalg.norm(part))
        if size > 0.0 and all(abs(part @ s) < MIN_CORRELATION_ALIKE * size for s in seen):
            seen.append(part / size)
            yield symbol


def _family(symbol: Symbol, touches: Touches) -> _Family:
    effects: list[Effect] = []
    at_once: dict[str, int] = {}
    lags: dict[str, IntArray] = {}
    for drive in drives(touches):
        if not is_speed(drive):
            at_once[drive] = len(effects)
            effects.append(follower(touches, symbol, drive))
        tuned = tuned_variants(ThermalLag(symbol, drive), touches)
        lags[drive] = len(effects) + np.arange(len(tuned))
        effects += tuned
    return _Family(tuple(effects), at_once, lags)


def _best(base: EffectSet, family: _Family) -> list[Effect]:
    """Effects of the body with most evidence; none where none pays for its freedom."""
    complement = base.complement
    C = complement.project(complement.columns(family.effects)) * PRIOR_FACTOR
    E = base.whiten(C)
    S, g = C.T @ C - E.T @ E, C.T @ complement.residual - E.T @ base.along
    best, top = np.zeros(0, dtype=np.int64), base.evidence + POLICY.log_evidence_gain
    for members in _members(family):
        part = S[members[:, :, None], members[:, None, :]] + np.eye(members.shape[1])
        along = g[members]
        drop = np.einsum("bk,bk->b", along, np.linalg.solve(part, along[..., None])[..., 0])
        log_det = base.log_det + np.linalg.slogdet(part)[1]
        evidence = log_evidence(base.objective - drop, log_det, complement.count, complement.stated)
        i = int(np.argmax(evidence))
        if evidence[i] > top:
            best, top = members[i], float(evidence[i])
    return _named([family.effects[i] for i in best])


def _members(family: _Family) -> Iterator[IntArray]:
    """Numbers of the effects of all bodies of one drive and one drive beside it, (B, K) each."""
    for drive, lags in family.lags.items():
        pairs = np.array(list(combinations(lags, 2)))
        own = [family.at_once[drive]] if drive in family.at_once else []
        beside = [[i] for d, i in family.at_once.items() if d != drive]
        for other in [[], *beside]:
            fixed = np.tile(np.array([*own, *other], dtype=np.int64), (len(pairs), 1))
            yield np.hstack([fixed, pairs])


def _named(effects: list[Effect]) -> list[Effect]:
    """The second of two lags after one drive by a name of its own."""
    out: list[Effect] = []
    for effect in effects:
        second = repeat(effect) if any(e.name == effect.name for e in out) else None
        out.append(second or effect)
    return out
