"""What changed on a machine over several runs, and when: control charts, files and page."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from matstd.api.runs import names_of, read_run
from matstd.api.saved import REPORT_FILES, Saveable, extended
from matstd.diagnosis.charts import (
    MIN_OCCASIONS,
    History,
    Occasion,
    history,
    history_csv,
    history_table,
    occasions_of_models,
    occasions_of_runs,
)
from matstd.diagnosis.files import read_model
from matstd.report.charts import write_history_page
from matstd.twin.compute import Progress, silent
from matstd.twin.display import Displayed
from matstd.twin.errors import BadArgument, NotEnoughData
from matstd.twin.files import write_whole
from matstd.twin.files.whole import write_json
from matstd.twin.record import Run

MODEL = "model.toml"

_DATE = re.compile(
    r"(?<!\d)(20\d\d)-?([01]\d)-?([0-3]\d)(?:[T_ -]?([0-2]\d)[-:h]?([0-5]\d))?(?!\d)"
)
"""A date in a name, with or without hyphens and time of day: `2031-05-06`, `20310506T0708`."""

_RUN = re.compile(r"#\s*format\s*=\s*.run/")


@dataclass(frozen=True, eq=False, repr=False)
class Trend(Saveable, Displayed, History):
    """A machine over several runs; `trend` returns it.

    Example:
        >>> found = trend("trend")
        >>> [chart.of.symbol for chart in found.changed if chart.course.drift]
        ['EC0Y']
    """

    sometimes = ("pictures/*.png", *REPORT_FILES)
    title: str = ""  # of what was charted
    # of the runs or models in the order of time; empty where records were given
    paths: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()  # files of the folder that are neither run nor model
    is_of_models: bool = False

    @property
    def follows(self) -> tuple[str, ...]:
        """Paths of the runs on both sides of the most certain step; empty without one."""
        for chart in self.changed:
            for step in chart.course.steps:
                if self.paths and not self.is_of_models:
                    return tuple(self.paths[chart.rows[step.after - i]] for i in (1, 0))
        return ()

    def write(self, folder: Path) -> str:
        """Write trend.json and trend.csv; as of `Saveable`."""
        write_json(folder / "trend.json", history_table(self))
        write_whole(folder / "trend.csv", history_csv(self))
        return ""

    def write_page(self, folder: Path) -> None:
        """Write the page into an existing folder."""
        follows = f"matstd diagnose {' '.join(self.follows)}" if self.follows else ""
        write_history_page(self, folder, self.title, follows)


def trend(
    runs: str | Path | Sequence[Run | str | Path],
    *,
    add: Sequence[str] = (),
    progress: Progress = silent,
) -> Trend:
    """Control charts of one machine over several runs: what changed, when, and how certainly.

    Args:
        runs: Runs, their files, model files, or folders of run files, of diagnoses or of model
            files; runs or models, not both. The date of a run is that of its head, else one in its
            name, `2031-05-06.csv`.
        add: Effects that are fitted to every run beside the geometry, by name.
        progress: Called with what is being done.

    Raises:
        BadFile: A file that cannot be read.
        BadArgument: Runs and models.
        DesignError: Runs of several machines or standards, or one twice.
        NotEnoughData: Fewer than three runs.

    Example:
        >>> found = trend("trend")
        >>> step = next(c for c in found.changed if c.of.symbol == "EX0C").course.steps[0]
        >>> found.occasions[step.after].name
        '2026-02-09'
    """
    named = [runs] if isinstance(runs, str | Path) else runs
    given: list[Run | str] = []
    left_out: list[str] = []
    for one in named:
        if isinstance(one, Run):
            given.append(one)
        elif Path(one).is_dir():
            files, others = _of_folder(Path(one))
            given += files
            left_out += others
        else:
            given.append(str(one))
    places = [str(one) for one in named if not isinstance(one, Run)]
    if len(given) < MIN_OCCASIONS:
        raise NotEnoughData(
            f"{', '.join(places) or 'runs'}: {len(given)} runs or models, expected at least "
            f"{MIN_OCCASIONS}; two runs are compared by matstd diagnose FIRST.csv SECOND.csv"
        )
    # model files hold their estimates: nothing is fitted again
    models = [one for one in given if isinstance(one, str) and one.endswith(".toml")]
    is_of_models = len(models) == len(given)
    if models and not is_of_models:
        raise BadArgument("runs", models[0], "runs alone, or models alone")
    made = _of_models(given) if is_of_models else _of_runs(given, add, progress)
    occasions = dated(made)
    found = history(occasions)
    order = {one.name: path for one, path in zip(occasions, given, strict=True)}
    paths = [order[one.name] for one in found.occasions]
    return extended(
        Trend,
        found,
        title=Path(places[0]).resolve().name if len(places) == len(named) == 1 else "runs",
        paths=tuple(p for p in paths if isinstance(p, str)),
        left_out=tuple(left_out),
        is_of_models=is_of_models,
    )


def dated(occasions: Sequence[Occasion]) -> list[Occasion]:
    """Occasions with the dates of their heads, else of their names.

    Where two heads state the same (the clock of the twin is always the same) the names count.
    """
    stated = [one.date for one in occasions if one.date is not None]
    if len(set(stated)) == len(stated):
        return [replace(one, date=one.date or date_of(one.name)) for one in occasions]
    return [replace(one, date=date_of(one.name) or one.date) for one in occasions]


def date_of(name: str) -> datetime | None:
    """The date in a name; None for none, or several.

    Example:
        >>> date_of("hsm_2031-05-06"), date_of("20310506T0708"), date_of("run 7")
        (datetime.datetime(2031, 5, 6, 0, 0), datetime.datetime(2031, 5, 6, 7, 8), None)
    """
    found = _DATE.findall(name)
    if len(found) != 1:
        return None
    try:
        year, month, day, hour, minute = (int(part or 0) for part in found[0])
        return datetime(year, month, day, hour, minute)
    except ValueError:  # month 13
        return None


def _of_folder(folder: Path) -> tuple[list[str], list[str]]:
    """Runs of a folder, or where it has none models; and what is neither."""
    tables = sorted(folder.glob("*.csv"))
    runs = [path for path in tables if _is_run(path)]
    if runs:
        return [str(path) for path in runs], [p.name for p in tables if p not in runs]
    models = [*folder.glob(f"*/{MODEL}"), *(p for p in folder.glob("*.toml") if _is_model(p))]
    return [str(path) for path in sorted(models)], [p.name for p in tables]


def _is_run(path: Path) -> bool:
    with path.open(encoding="utf-8", errors="replace") as file:
        return bool(_RUN.match(file.read(100).lstrip("\ufeff")))


def _is_model(path: Path) -> bool:
    return path.read_text(encoding="utf-8", errors="replace").startswith('format = "model/')


def _of_runs(given: Sequence[Run | str], add: Sequence[str], progress: Progress) -> list[Occasion]:
    """Runs fitted one after the other."""
    runs = [one if isinstance(one, Run) else read_run(one) for one in given]
    names = names_of(given)
    by_date = sorted(
        zip(names, runs, strict=True), key=lambda one: (str(one[1].date or ""), one[0])
    )
    made = {one.name: one for one in occasions_of_runs(dict(by_date), add, progress)}
    return [made[name] for name in names]


def _of_models(given: Sequence[Run | str]) -> list[Occasion]:
    """Saved models, by the name of their folder where that is of a diagnosis."""
    names = names_of(given, lambda p: p.parent.name if p.name == MODEL else p.stem)
    paths = [str(one) for one in given]
    return occasions_of_models(
        {name: read_model(path) for name, path in zip(names, paths, strict=True)}
    )
