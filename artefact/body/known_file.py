"""Reader and writer of `[calibration]` of a `standard.toml`."""

from typing import Annotated, Any, Literal

from pydantic import Field

from matstd.artefact.body.known import Known, KnownFeature, Verdict
from matstd.twin.files import Table
from matstd.twin.units import UM, URAD


class _KnownFeature(Table):
    points: Annotated[int, Field(ge=1)]
    u_um: Annotated[float, Field(ge=0.0)]
    u_urad: Annotated[float, Field(ge=0.0)] = 0.0
    u_form_um: Annotated[float, Field(ge=0.0)] = 0.0


class _Verdict(Table):
    feature: str
    characteristic: Literal["diameter", "position", "profile", "scale"]
    deviation_um: float
    tolerance_um: Annotated[float, Field(ge=0.0)]
    u_um: Annotated[float, Field(ge=0.0)]
    verdict: str = ""


class KnownTable(Table):
    """`[calibration]`."""

    source: str
    nominal: str
    feature: dict[str, _KnownFeature]
    verdict: list[_Verdict] = Field(default_factory=list)

    def known(self) -> Known:
        """The calibration in base units."""
        return Known(
            source=self.source,
            nominal=self.nominal,
            features={
                name: KnownFeature(f.points, f.u_um * UM, f.u_urad * URAD, f.u_form_um * UM)
                for name, f in self.feature.items()
            },
            verdicts=tuple(
                Verdict(
                    feature=v.feature,
                    characteristic=v.characteristic,
                    deviation=v.deviation_um * UM,
                    tolerance=v.tolerance_um * UM,
                    u=v.u_um * UM,
                )
                for v in self.verdict
            ),
        )


def known_table(known: Known) -> dict[str, Any]:
    """The calibration as the table of the file."""
    return {
        "source": known.source,
        "nominal": known.nominal,
        "feature": {
            name: {
                "points": f.points,
                "u_um": round(f.u / UM, 4),
                "u_urad": round(f.u_tilt / URAD, 3),
                "u_form_um": round(f.u_form / UM, 4),
            }
            for name, f in known.features.items()
        },
        "verdict": [_verdict_table(verdict) for verdict in known.verdicts],
    }


def _verdict_table(verdict: Verdict) -> dict[str, Any]:
    return {
        "feature": verdict.feature,
        "characteristic": verdict.characteristic,
        "deviation_um": round(verdict.deviation / UM, 4),
        "tolerance_um": round(verdict.tolerance / UM, 4),
        "u_um": round(verdict.u / UM, 4),
        "verdict": f"{verdict.state}{', accepted' if verdict.is_refused else ''}",
    }
