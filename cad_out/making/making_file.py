"""Everything about the making of a standard, and its file."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matstd.artefact.body import Material, Standard
from matstd.artefact.price import Construction, Estimate, Price, construction_to_make, prices_of
from matstd.cad_out.details import details_of
from matstd.cad_out.making.cutting import OVERHANG, RADIUS, Cutting, cutting_of
from matstd.cad_out.making.hints import ROUGHNESS, FaceHint, hints_of
from matstd.cad_out.making.joints import joints_if_any
from matstd.cad_out.making.stiffness import Stiffness
from matstd.twin.files.whole import write_json
from matstd.twin.units import DEG, UM

FIRST_MODE, SAG = 500.0, 0.1 * UM  # least first mode, Hz; most sag that needs no correction, mm


@dataclass(frozen=True, eq=False)
class Making:
    """Whether a standard can be cut, and how it stands."""

    cutting: Cutting  # reach of cutters
    # first mode and sag; None where the modulus of the material is not known
    stiffness: Stiffness | None
    hints: dict[str, FaceHint]  # how every face is milled
    material: Material
    # estimates of both constructions; none for a material without rates
    prices: tuple[Price, ...] = ()
    make: Construction = Construction.BILLET  # the construction that the workshop should make


def making_of(standard: Standard, stiffness: Stiffness | None) -> Making:
    """Cutters of a standard, beside its stiffness."""
    details, prices = details_of(standard), prices_of(standard)
    cutting, hints = cutting_of(standard, details), hints_of(standard)
    return Making(
        cutting=cutting,
        stiffness=stiffness,
        hints=hints,
        material=standard.material,
        prices=prices,
        make=construction_to_make(prices, joints_if_any(standard, details) is not None),
    )


def write_making(path: Path, making: Making) -> None:
    """All figures with their limits as JSON; lengths in their names' units."""
    cutting = making.cutting
    table: dict[str, Any] = {
        "format": "making/1",
        "finishing_cutter": {"diameter_mm": 2.0 * RADIUS, "overhang_mm": OVERHANG},
        "points": cutting.points,
        "reached_upright": cutting.upright,
        "reached_tilted_45_deg": cutting.tilted,
        "out_of_reach": list(cutting.out_of_reach),
        "overhang_for_all_mm": cutting.overhang if cutting.overhang < 1e6 else None,
        "faces": {
            face: {
                "least_concave_radius_mm": _finite(radius),
                "least_concave_radius_with_overhang_mm": _finite(cutting.whole_radius[face]),
                "ball_end_mill_mm": cutting.cutter[face],
                **_hint_table(making.hints[face]),
            }
            for face, radius in cutting.radius.items()
        },
        **_stiffness_table(making.stiffness, making.material),
        "constructions": {price.construction: _price_table(price) for price in making.prices},
        "make": making.make,
        "first_mode_limit_Hz": FIRST_MODE,
        "sag_limit_um": SAG / UM,
    }
    write_json(path, table)


def _stiffness_table(stiffness: Stiffness | None, material: Material) -> dict[str, Any]:
    """Figures that depend on the modulus; null where it is not known."""
    if stiffness is None:
        keys = ("modulus_MPa", "first_mode_Hz", "ball_N_um", "element_mm", "sag_um", "sag_worst")
        return {"material": material.name, **dict.fromkeys(keys)}
    name, sag = stiffness.worst
    return {
        "material": material.name,
        "modulus_MPa": material.modulus,
        "modulus_source": material.modulus_source,
        "poisson": material.poisson,
        "first_mode_Hz": stiffness.first_mode,
        "ball_N_um": {ball: force * UM for ball, force in stiffness.at_balls.items()},
        "element_mm": stiffness.cube,
        "sag_um": {feature: value / UM for feature, value in stiffness.sag.items()},
        "sag_worst": {"feature": name, "um": sag / UM},
    }


def _finite(radius: float) -> float | None:
    """A radius; None of a face that is convex everywhere."""
    return radius if radius < 1e6 else None


def _price_table(price: Price) -> dict[str, Any]:
    """Figures of a construction, each with its standard uncertainty."""
    return {
        "stock_kg": round(price.stock, 1),
        "price_EUR": _with_u(price.total),
        "weeks": _with_u(price.weeks),
        "hours": {name: _with_u(one) for name, one in price.hours.items()},
        "bought_EUR": {name: _with_u(one) for name, one in price.bought.items()},
    }


def _with_u(one: Estimate) -> list[float]:
    return [round(float(one.value), 1), round(float(one.u), 1)]


def _hint_table(hint: FaceHint) -> dict[str, Any]:
    """Figures of one face for the finishing cutter; angles in degrees, null where no axis suits."""
    return {
        "least_convex_radius_mm": _finite(hint.convex),
        "slope_deg": [_degrees(angle) for angle in hint.slope],
        "step_over_mm": {
            f"Ra {ra / UM:g} um": width for ra, width in zip(ROUGHNESS, hint.step_over, strict=True)
        },
        "tilts_deg": [_degrees(tilt) for tilt in hint.tilts],
        "best_tilt_deg": None if hint.axis is None else _degrees(hint.axis[0]),
        "best_azimuth_deg": None if hint.axis is None else _degrees(hint.axis[1]),
        "contact_angle_deg": None
        if hint.contact is None
        else [_degrees(angle) for angle in hint.contact],
    }


def _degrees(angle: float) -> float:
    return round(angle / DEG, 6)
