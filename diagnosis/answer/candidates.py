"""What every effect of the library would do by itself, the most likely first."""

from dataclasses import dataclass

from matstd.diagnosis.search import Search, SearchState
from matstd.twin.numbers import rms

MAX_LISTED = 25  # most candidates that are listed


@dataclass(frozen=True, slots=True)
class Candidate:
    """What one effect of the library by itself would do for the starting model; mm."""

    effect: str
    kind: str
    p_value: float
    rms: float
    test_rms: float
    log_odds: float


def ranked_candidates(final: SearchState) -> tuple[Candidate, ...]:
    """Library effects by themselves, best first, with their held-out errors."""
    search = Search(final.pool)
    nothing = search.evaluate(())
    scores = search.scores(nothing)
    n = len(final.pool.complement.u)
    out = []
    for variant in search.ranking(nothing)[:MAX_LISTED]:
        member = search.member(nothing, variant)
        effects = search.evaluate((member,)).effects
        u = final.pool.complement.u
        out.append(
            Candidate(
                effect=member.effect.name,
                kind=member.effect.kind,
                p_value=search.corrected(member, float(scores.p[variant])),
                rms=rms(effects.residual[:n] * u),
                test_rms=rms(effects.held_out.error * u),
                log_odds=float(effects.evidence - nothing.effects.evidence),
            )
        )
    return tuple(out)
