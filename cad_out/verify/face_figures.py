"""Faces of the files against their design, by scipy and quadrature."""

import numpy as np

from matstd.artefact.body import Standard
from matstd.cad_out.verify.part21 import SphereFace, SplineFace
from matstd.twin.sampling import grid_points

_SAMPLES = 61  # points along each side of a face that is compared


def face_deviations(
    standard: Standard, faces: dict[str, SplineFace | SphereFace | None]
) -> dict[str, float]:
    """Largest distance of every patch and sphere in the file from its design, mm.

    Patches are compared point by point at equal parameters: the file's spline by scipy, the
    design by its own formula. A face that is missing or of another kind counts as infinitely far.
    """
    deviations = {}
    for patch in standard.patches:
        face, (a, b) = faces.get(patch.name), patch.half_size
        if not isinstance(face, SplineFace):
            deviations[patch.name] = np.inf
            continue
        axes = np.linspace(-a, a, _SAMPLES), np.linspace(-b, b, _SAMPLES)
        uv = grid_points(*axes)
        apart = np.linalg.norm(face.points(uv) - patch.point(uv), axis=1)
        deviations[patch.name] = float(apart.max())
    for sphere in standard.spheres:
        face = faces.get(sphere.name)
        if not isinstance(face, SphereFace):
            deviations[sphere.name] = np.inf
            continue
        apart = np.linalg.norm(face.centre - sphere.centre) + abs(face.radius - sphere.radius)
        deviations[sphere.name] = float(apart)
    return deviations


def area_errors(standard: Standard, areas: dict[str, float]) -> dict[str, float]:
    """Relative difference between the area of a face's triangles and that of its design."""
    errors = {}
    for patch in standard.patches:
        nodes, weights = np.polynomial.legendre.leggauss(40)
        a, b = patch.half_size
        u, v = np.meshgrid(a * nodes, b * nodes, indexing="ij")
        j = patch.jet(np.column_stack([u.ravel(), v.ravel()]))
        weight = a * b * np.outer(weights, weights).ravel()
        area = float(weight @ np.sqrt(1.0 + j.hu**2 + j.hv**2))
        errors[patch.name] = abs(areas.get(patch.name, 0.0) / area - 1.0)
    return errors
