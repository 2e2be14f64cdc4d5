"""The folder that goes with the programs: set-up sheet, dry run, search for the standard."""

from pathlib import Path

from probe_paths.emit import Feeds, ProgramSet, make_dry_run, make_search
from probe_paths.language import Dialect
from probe_paths.locate import Spread, plan_search
from probe_paths.plan import TouchPlan
from report.pages import write_setup_page
from twin.errors import NotReachable

SHEET = "setup"
"""Folder of the set-up sheet."""

SHEET_FILES = (f"{SHEET}/setup.pdf", f"{SHEET}/tables/*.csv", f"{SHEET}/*_LOC.*")
"""Of it, what not every run leaves."""

RAISED = 100.0
"""Of a dry run, mm."""


def write_setup_files(
    folder: Path,
    plan: TouchPlan,
    programs: ProgramSet,
    dialect: Dialect,
    feeds: Feeds,
    raised: float = RAISED,
) -> Path:
    """Write the sheet and the programs that are run before the others; the path of the page.

    Args:
        folder: Of the results.
        plan: Of the programs.
        programs: As written.
        dialect: Of the control.
        feeds: Of the programs.
        raised: By how much the dry run is raised, mm.
    """
    here = folder / SHEET
    dry_run, spread = make_dry_run(plan, raised, dialect, feeds), Spread()
    dry_run.write(here)
    search: ProgramSet | str
    try:
        search = make_search(
            search_of(plan, spread), (spread.distance, spread.angle), dialect, feeds
        )
        search.write(here)
    except NotReachable as error:
        search = str(error)
    return write_setup_page(here, plan, programs, dry_run, search, dialect)


def search_of(plan: TouchPlan, spread: Spread) -> TouchPlan:
    """The search for the standard of a plan."""
    return plan_search(
        plan.standard,
        plan.chain,
        plan.probe,
        plan.setup,
        spread,
        plan.options.workshop,
        plan.options.retract,
    )
