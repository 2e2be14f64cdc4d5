"""Choosing patches, table poses and touches by what they tell of the machine."""

from artefact.place.placement import Placement, PlacementOptions, place

__all__ = ["Placement", "PlacementOptions", "place"]
