"""The piece that the twin probes: not at 20 degC, and not as its certificate states."""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.brief import StudySettings
from matstd.artefact.worth import Calibration
from matstd.twin.record import U_SHARE, Run, StatedBody, with_body
from matstd.twin.units import T_REF


@dataclass(frozen=True)
class WarmBody:
    """Temperature, expansion and scale of a standard, with what a run states of them.

    The thermometer reads `temperature`; the piece differs from it, and from its stated expansion
    and lengths, at random by their standard uncertainties.
    """

    temperature: float  # as read, degC
    u_temperature: float  # of the reading, K
    expansion: float  # as stated, 1/K
    u_expansion: float
    u_scale: float  # of the calibrated lengths, relative

    @classmethod
    def of(cls, study: StudySettings, standard: Standard, known: Calibration) -> "WarmBody":
        """The body of a standard in the proof of a project."""
        made_of = standard.material
        u = made_of.u_expansion
        return cls(
            temperature=study.body_temperature,
            u_temperature=study.body_u,
            expansion=made_of.expansion,
            u_expansion=U_SHARE * made_of.expansion if u is None else u,
            u_scale=known.scale,
        )

    def pieces(self, standard: Standard, count: int, rng: np.random.Generator) -> list[Standard]:
        """One piece at `count` visits, each time with another error of the thermometer."""
        alpha = rng.normal(self.expansion, self.u_expansion)
        scale = rng.normal(0.0, self.u_scale)
        at = rng.normal(self.temperature, self.u_temperature, count)
        return [standard.scaled(1.0 + scale + alpha * (t - T_REF)) for t in at]

    def stated_in(self, run: Run) -> Run:
        """The run with what is known of the size of its standard."""
        stated = StatedBody(
            self.expansion,
            self.u_expansion,
            body_degC=self.temperature,
            body_u_K=self.u_temperature,
            scale_u_ppm=1e6 * self.u_scale,
        )
        return with_body(run, stated)
