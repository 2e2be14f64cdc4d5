"""What a design run made: the record that its page shows."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from matstd.artefact.body import Standard
from matstd.artefact.brief import Brief
from matstd.artefact.compare import IdentifiabilityReport, WorstRegions
from matstd.artefact.place import Placement
from matstd.cad_out.making import Making
from matstd.cad_out.verify import Conformity
from matstd.diagnosis.accuracy import Proof
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.task import TaskUncertainty, Visits
from matstd.probe_paths.campaign import Campaign
from matstd.probe_paths.emit import ProgramSet
from matstd.probe_paths.plan import TouchPlan
from matstd.probe_paths.stations import Station, all_programs
from matstd.report.pages.time_section import MachineTimes
from matstd.sensitivity.study import Study
from matstd.twin.display import Displayed
from matstd.twin.frames import Array
from matstd.twin.model import Effect


@dataclass(frozen=True, eq=False)
class Proven:
    """One random machine, probed with the emitted programs and identified."""

    seed: int  # of its errors and noise, beside the project's
    errors: list[tuple[Effect, Array]]  # its true errors
    campaign: Campaign  # the programs run on its twin
    fit: Fit  # the identified model
    proof: Proof  # predicted against true volumetric error over the probed volume
    in_workspace: Proof  # the same over the user's workspace


@dataclass(frozen=True, eq=False, repr=False)
class Design(Displayed):
    """Everything that a design run made; the files of the same names hold it."""

    brief: Brief  # what was asked for
    study: Study  # sensitivities and random machines
    maps: list[tuple[str, str]]  # file and caption of the study's pictures
    placement: Placement  # standard and touches
    worst: WorstRegions  # what the faces see of the poses that are wrong again and again
    conformity: Conformity  # CAD files, measured after they were written
    making: Making  # reach of cutters, first mode, sag
    # touches in their order and the programs that make them, by clamping and probe
    stations: tuple[Station, ...]
    machines: tuple[Proven, ...]  # random machines, probed and identified
    identifiability: IdentifiabilityReport  # what the touches can and cannot distinguish
    # number of parameters that the first machine's data decide rather than the prior
    effective: float
    # uncertainty of the user's task on the first machine, by what corrects results
    budgets: Mapping[str, TaskUncertainty]
    visits: Visits  # what they rest upon
    times: MachineTimes  # time on the machine of every artefact, and of every order of the touches
    remarks: tuple[str, ...] = ()  # what could not be drawn
    folder: Path | None = None  # with the files; None before they are in their place

    @property
    def standard(self) -> Standard:
        """The standard."""
        return self.placement.standard

    @property
    def plan(self) -> TouchPlan:
        """Touches of the probe and the clamping that the standard is designed for."""
        return self.stations[0].plan

    @property
    def programs(self) -> ProgramSet:
        """All programs."""
        return all_programs(self.stations)
