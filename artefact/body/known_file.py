"""Reader and writer of `[calibration]` of a `standard.toml`."""

from typing import Annotated, Any, Literal

from pydantic import Field

from matstd.artefact.body.known import Known, KnownFeature, Verdict
from matstd.twin.files import Table
from matstd.twin.units import UM, URAD

PPM = 1e-6


class _KnownFeature(Table):
    points: Annotated[int, Field(ge=1)]
    u_um: Annotated[float, Field(ge=0.0)]
    u_urad: Annotated[float, Field(ge=0.0)] = 0.0
    u_form_um: Annotated[float, Field(ge=0.0)] = 0.0
    u_axes_um: Annotated[list[float] | None, Field(min_length=3, max_length=3)] = None

    def feature(self) -> KnownFeature:
        """In base units."""
        axes = self.u_axes_um
        return KnownFeature(
            points=self.points,
            u=self.u_um * UM,
            u_tilt=self.u_urad * URAD,
            u_form=self.u_form_um * UM,
            u_axes=None if axes is None else (axes[0] * UM, axes[1] * UM, axes[2] * UM),
        )


class _Verdict(Table):
    feature: str
    characteristic: Literal["diameter", "form", "position", "profile", "scale"]
    deviation_um: float
    tolerance_um: Annotated[float, Field(ge=0.0)]
    u_um: Annotated[float, Field(ge=0.0)]
    verdict: str = ""


class KnownTable(Table):
    """`[calibration]`."""

    source: str
    nominal: str
    scale_u_ppm: Annotated[float | None, Field(ge=0.0)] = None
    feature: dict[str, _KnownFeature]
    verdict: list[_Verdict] = Field(default_factory=list)

    def known(self) -> Known:
        """The calibration in base units."""
        return Known(
            source=self.source,
            nominal=self.nominal,
            features={name: f.feature() for name, f in self.feature.items()},
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
            u_scale=None if self.scale_u_ppm is None else self.scale_u_ppm * PPM,
        )


def known_table(known: Known) -> dict[str, Any]:
    """The calibration as the table of the file."""
    return {
        "source": known.source,
        "nominal": known.nominal,
        **({} if known.u_scale is None else {"scale_u_ppm": round(known.u_scale / PPM, 4)}),
        "feature": {
            name: {
                "points": f.points,
                "u_um": round(f.u / UM, 4),
                "u_urad": round(f.u_tilt / URAD, 3),
                "u_form_um": round(f.u_form / UM, 4),
                **({} if f.u_axes is None else {"u_axes_um": [round(u / UM, 4) for u in f.u_axes]}),
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
