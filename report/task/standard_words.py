"""What a standard is made of, in words."""

from matstd.artefact.body import Material
from matstd.artefact.layout import SOFT
from matstd.twin.units import GPA


def modulus_words(material: Material) -> str:
    """The modulus that stiffness and sag rest on, or that there is none."""
    if material.modulus is None:
        return (
            f"unknown: no modulus is stated of '{material.name}'; state material.modulus_MPa. "
            f"Posts are drawn for {SOFT / GPA:g} GPa, no sag is taken off"
        )
    return (
        f"{material.modulus / GPA:g} GPa, Poisson's ratio {material.poisson:g} of "
        f"'{material.name}' ({material.modulus_source})"
    )
