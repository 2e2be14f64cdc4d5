"""Programs of every station, each with its tool and letters of its own in front of their names."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from matstd.probe_paths.emit import Feeds, ProgramSet, make_programs
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import TouchPlan


@dataclass(frozen=True, eq=False)
class Station:
    """What one probe does in one clamping."""

    plan: TouchPlan
    dialect: Dialect  # words of the control, with the probe's tool
    programs: ProgramSet

    @property
    def setup(self) -> str:
        """Name of the clamping."""
        return self.plan.setup.name


def with_tool(dialect: Dialect, tool: int) -> Dialect:
    """Words for a further probe; all its names begin with the tool: `MS31_A_1`."""
    return replace(dialect, tool=tool, prefix=f"{dialect.prefix}{tool}")


def make_stations(
    plans: Sequence[tuple[int, TouchPlan]], words: Sequence[Dialect], feeds: Feeds | None = None
) -> tuple[Station, ...]:
    """Programs of the plans of a campaign.

    Args:
        plans: As of `plan_campaign`, with the number of the probe.
        words: Words of the control, for every probe.
    """
    return tuple(
        Station(plan, words[probe], make_programs(plan, words[probe], feeds))
        for probe, plan in plans
    )


def all_programs(stations: Sequence[Station]) -> ProgramSet:
    """Programs of all stations in their order; masks that they share are the same."""
    programs = tuple(program for one in stations for program in one.programs.programs)
    masks = {name: text for one in stations for name, text in one.programs.masks.items()}
    return ProgramSet(programs, masks)
