"""Sheets of a campaign, and the programs that are run beside those that measure."""

from collections.abc import Sequence
from pathlib import Path

from matstd.compensation.field import MachineErrors
from matstd.options import print_report
from matstd.probe_paths.emit import Feeds
from matstd.probe_paths.locate import RAISED, companions
from matstd.probe_paths.stations import Station
from matstd.report.pages import Printer, write_setup_page


def write_sheets(
    folder: Path,
    stations: Sequence[Station],
    feeds: Feeds,
    printed_by: Printer | None,
    raised: float = RAISED,
    errors: MachineErrors | None = None,
    conditions: Sequence[str] = (),
) -> None:
    """Write a sheet for every station, a PDF with `printed_by`, and the programs beside it.

    Other arguments as of `write_setup_page`.
    """
    setups: set[str] = set()
    for number, station in enumerate(stations):
        is_further = station.setup in setups
        setups.add(station.setup)
        plan, words = station.plan, station.dialect
        others = companions(plan, words, feeds, raised, is_further=is_further)
        others.write(folder)
        sheet = write_setup_page(folder, stations, number, others, errors, conditions)
        print_report(folder, printed_by, sheet.stem)
