"""What a brief asks of the programs: words of the control, feeds, and how carefully to plan."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from matstd.artefact.brief import Brief
from matstd.probe_paths.emit import SEARCH, Feeds, ProgramSet, make_programs
from matstd.probe_paths.language import Dialect, checked_name, read_dialect
from matstd.probe_paths.plan import PlanOptions, Sensor, TouchPlan
from matstd.twin.display import Displayed
from matstd.twin.errors import BadFile


@dataclass(frozen=True, eq=False, repr=False)
class Station(Displayed):
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
    """
    named = ((plan, words[probe]) for probe, plan in plans)
    return tuple(Station(plan, word, make_programs(plan, word, feeds)) for plan, word in named)


def all_programs(stations: Sequence[Station]) -> ProgramSet:
    """Programs of all stations in their order; masks that they share are the same."""
    programs = tuple(program for one in stations for program in one.programs.programs)
    masks = {name: text for one in stations for name, text in one.programs.masks.items()}
    return ProgramSet(programs, masks)


_DROPPED = 0.1
"""Share of touches that a plan may drop, each with its reason: the choice checks touches only,
the plan every move."""


def dialects_of(brief: Brief) -> list[Dialect]:
    """Words of the control, and numbers of this workshop, for every probe.

    Raises:
        BadFile: A folder for a control that takes none, planes of one that has none, or of a
            machine that turns its tool; sensors for a control that does not hand them over.
        DesignError: Names of programs that no control takes.
    """
    wanted = brief.programs
    words = read_dialect(wanted.control, brief.path.parent)
    if wanted.folder is not None and not words.folder:
        raise BadFile(brief.path, "workshop.folder", wanted.folder, "nothing for this control")
    sensors = tuple(Sensor(name, *values) for name, values in wanted.temperatures.items())
    if sensors and words.language != "klartext":
        found = f"{len(sensors)} sensors for {wanted.control}"
        expected = "a control that hands them over as Q100 to Q107; else evaluate --sensors"
        raise BadFile(brief.path, "workshop.temperatures", found, expected)
    first = replace(
        words,
        is_tilted=_is_tilted(brief, words),
        sensors=sensors,
        folder=words.folder if wanted.folder is None else wanted.folder,
        tool=words.tool if wanted.tool is None else wanted.tool,
        preset=words.preset if wanted.preset is None else wanted.preset,
        result_height=wanted.height_read or words.result_height,
    )
    every = [first, *(with_tool(first, tool) for tool in wanted.further_tools)]
    for setup in brief.setups[1:]:
        checked_name(f"{every[-1].prefix}_{setup.name.upper()}_{SEARCH}")
    return every


def _is_tilted(brief: Brief, words: Dialect) -> bool:
    """Whether programs use planes; refuses a control or machine without them."""
    if not brief.programs.planes:
        return False
    chain = brief.chain
    turns = [a for a in chain.rotary_axes if not chain.link(a).carries_workpiece]
    if not words.has_planes or turns:
        why = "a dialect with has_planes = true"
        why = f"axes on this machine, whose tool {turns[0]} turns" if words.has_planes else why
        raise BadFile(brief.path, "workshop.strategy", repr("plane-spatial"), why)
    return True


def feeds_of(brief: Brief) -> Feeds:
    """Feeds of the programs, and where a file ends."""
    wanted = brief.programs
    return Feeds(
        probing=wanted.probing_feed,
        approach=wanted.approach_feed,
        turning=wanted.turning_feed,
        touches_per_file=wanted.touches_per_file,
        minutes_per_file=wanted.minutes_per_file,
    )


def plan_options_of(brief: Brief) -> PlanOptions:
    """How carefully touches are made: with half the room that they are chosen for."""
    return PlanOptions(
        smallest_gap=0.5 * brief.room,
        clearance=brief.programs.clearance,
        tolerated=int(_DROPPED * brief.options.choice.touches),
        retract=brief.programs.retract,
        workshop=brief.reach.workshop,
    )
