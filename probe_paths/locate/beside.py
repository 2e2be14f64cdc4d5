"""The programs that are run before those of a plan: a dry run, and a search for the standard."""

from dataclasses import dataclass
from pathlib import Path

from probe_paths.emit import Feeds, ProgramSet, make_dry_run, make_search
from probe_paths.language import Dialect
from probe_paths.locate.search_plan import Spread, plan_search
from probe_paths.plan import TouchPlan
from twin.errors import NotReachable
from twin.units import DEG

RAISED = 100.0
"""Of a dry run, mm."""

SPREADS = tuple(Spread(d, a * DEG) for d, a in ((20.0, 5.0), (15.0, 4.0), (10.0, 3.0), (5.0, 2.0)))
"""That a search is made for, the first for which there is one: by eye, by a rule, by a stop. A
standard of tall posts leaves a short stylus no room to come down wherever it may stand."""


@dataclass(frozen=True)
class Companions:
    """Programs that go with those of a plan.

    Attributes:
        dry_run: Where the programs go, higher, without a touch.
        raised: By how much, mm.
        search: For the standard; None where there can be none.
        spread: Within which it is found.
        no_search: Why there is no search.
    """

    dry_run: ProgramSet
    raised: float
    search: ProgramSet | None
    spread: Spread
    no_search: str = ""

    def write(self, folder: Path) -> None:
        """Write programs and masks into a folder."""
        self.dry_run.write(folder)
        if self.search is not None:
            self.search.write(folder)


def companions(
    plan: TouchPlan,
    dialect: Dialect,
    feeds: Feeds,
    raised: float = RAISED,
    spread: Spread | None = None,
) -> Companions:
    """Dry run and search of a plan.

    Args:
        plan: Of the programs.
        dialect: Of the control.
        feeds: Of the programs.
        raised: By how much the dry run is raised, mm.
        spread: Within which the search finds the standard; None for the widest of `SPREADS` for
            which there is a search.
    """
    dry_run = make_dry_run(plan, raised, dialect, feeds)
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
            why = str(error)
            continue
        made = make_search(search, (chosen.distance, chosen.angle), dialect, feeds)
        return Companions(dry_run=dry_run, raised=raised, search=made, spread=chosen)
    return Companions(dry_run=dry_run, raised=raised, search=None, spread=chosen, no_search=why)
