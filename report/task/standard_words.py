"""The material of a standard, in words."""

from matstd.artefact.body import Material
from matstd.artefact.layout import SOFT
from matstd.twin.units import GPA


def modulus_words(material: Material) -> str:
    """Young's modulus, as used for stiffness and sag."""
    if material.modulus is None:
        return (
            f"unknown: no modulus is stated for '{material.name}'; state material.modulus_MPa. "
            f"Posts are designed for {SOFT / GPA:g} GPa, sag is not corrected"
        )
    return (
        f"{material.modulus / GPA:g} GPa, Poisson's ratio {material.poisson:g} of "
        f"'{material.name}' ({material.modulus_source})"
    )
