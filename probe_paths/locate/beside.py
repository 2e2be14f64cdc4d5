"""Programs beside those of a plan: a dry run, a search for the standard, one ball, one touch."""

from dataclasses import dataclass, replace
from pathlib import Path

from matstd.probe_paths.emit import (
    Feeds,
    ProgramSet,
    make_ball,
    make_dry_run,
    make_first,
    make_search,
)
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.locate.ball_plan import plan_ball
from matstd.probe_paths.locate.search_plan import plan_search
from matstd.probe_paths.locate.spread import SPREADS, Spread
from matstd.probe_paths.plan import TouchPlan
from matstd.twin.errors import NotReachable

RAISED = 100.0
"""Height by which a dry run is raised, mm."""


@dataclass(frozen=True)
class Companions:
    """Programs that go with those of a plan."""

    dry_run: ProgramSet  # where the programs go, higher, without a touch
    raised: float  # by how much, mm
    spread: Spread  # within which a search finds the standard
    search: ProgramSet | None = None  # for the standard; None where there can be none
    no_search: str = ""
    # touches on one ball, before the programs and after them; None where there can be none
    ball: ProgramSet | None = None
    no_ball: str = ""
    # one touch that a control is tried with; None where there is none
    first: ProgramSet | None = None

    def write(self, folder: Path) -> None:
        """Write programs and masks into a folder."""
        for programs in (self.dry_run, self.search, self.ball, self.first):
            if programs is not None:
                programs.write(folder)


def companions(
    plan: TouchPlan,
    dialect: Dialect,
    feeds: Feeds,
    raised: float = RAISED,
    spread: Spread | None = None,
    is_further: bool = False,
) -> Companions:
    """Dry run, search, ball and commissioning program of a plan.

    Args:
        raised: By how much the dry run is raised, mm.
        spread: Within which the search finds the standard; None for the widest of `SPREADS` for
            which there is a search.
        is_further: Whether another probe has already searched and tried the control.
    """
    made = Companions(
        dry_run=make_dry_run(plan, raised, dialect, feeds), raised=raised, spread=SPREADS[-1]
    )
    is_beside = plan.options.workshop.ball is not None
    try:
        own = plan_ball(plan)
        ball = plan_ball(plan, is_beside) if is_beside else own
        made = replace(made, ball=make_ball(ball, dialect, feeds))
        if dialect.language == "klartext" and not is_further:
            made = replace(made, first=make_first(own, dialect, feeds))
    except NotReachable as error:
        made = replace(made, no_ball=str(error))
    if is_further:
        return replace(made, no_search="the first probe of this set-up has found it")
    # the widest spread comes first, a narrower one where it allows no search
    for chosen in SPREADS if spread is None else (spread,):
        try:
            search = plan_search(
                plan.standard,
                plan.chain,
                plan.probe,
                plan.setup,
                chosen,
                plan.options.workshop,
                plan.options.retract,
            )
        except NotReachable as error:
            made = replace(made, spread=chosen, no_search=str(error))
            continue
        programs = make_search(search, (chosen.distance, chosen.angle), dialect, feeds)
        return replace(made, search=programs, spread=chosen, no_search="")
    return made
