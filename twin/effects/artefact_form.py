"""Form of the standard that differs from its calibration, patch by patch."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.polynomial.legendre import legvander

from matstd.twin.fields import Argument
from matstd.twin.frames import Array
from matstd.twin.model import Declared, Kind, Parameter, Term, Where
from matstd.twin.record import Touches
from matstd.twin.units import UM

FORM_DEGREE = 5
"""Degree of the polynomial over a patch, 21 coefficients: waves down to the size of the patch."""
DEGREES = [(i, n - i) for n in range(FORM_DEGREE + 1) for i in range(n, -1, -1)]
"""Exponents of v and w of every coefficient, by rising degree."""
FORM_TOUCHES = 30
"""Fewest touches on a patch whose form is proposed: about three for two of its 21 coefficients."""


@dataclass(frozen=True)
class ArtefactForm(Declared):
    """The form of one patch deviates smoothly from its calibration.

    ``p_i = sqrt(2 i + 1) P_i``, the Legendre polynomials of unit mean square over the touched
    rectangle; v and w in [-1, 1] run along the two longest directions of the touched points. The
    length of (a_ij) is thus the amplitude of a wave ``a sin(k v) sin(l w)`` of the same mean
    square. Coefficients are expected to fall with the degree. The touches must be the whole run:
    its points on the patch give the rectangle.
    """

    patch: Annotated[str, Argument("patch")]

    kind, called, carrier = "artefact-form", "form of {patch}", "standard"
    parameters = tuple(
        Parameter(f"P{i}{j}", "mm", 1.5 * UM / np.sqrt(1.0 + i + j)) for i, j in DEGREES
    )

    def terms(self, touches: Touches) -> Sequence[Term]:
        rows = np.flatnonzero(touches.feature == self.patch)
        unit = np.sqrt(2.0 * np.arange(FORM_DEGREE + 1) + 1.0)
        v, w = (legvander(x, FORM_DEGREE) * unit for x in _local(touches.point[rows]).T)
        out = []
        for k, (i, j) in enumerate(DEGREES):
            amount = np.zeros(len(touches))
            amount[rows] = 0.5 * v[:, i] * w[:, j]
            out.append(Term(k, Where("bias"), amount))
        return tuple(out)


def _local(point: Array) -> Array:
    """Places (M, 2) in [-1, 1] over the rectangle of points (M, 3) along their two longest axes."""
    if len(point) < 3:
        return np.zeros((len(point), 2))
    _, _, axes = np.linalg.svd(point - point.mean(axis=0), full_matrices=False)
    # the sign of a singular vector is arbitrary: let its largest entry be positive
    axes = axes[:2] * np.sign(axes[np.arange(2), np.argmax(np.abs(axes[:2]), axis=1)])[:, None]
    place = point @ axes.T
    low, high = place.min(axis=0), place.max(axis=0)
    return (2.0 * place - low - high) / np.maximum(high - low, 1e-9)


def propose(touches: Touches) -> Iterable[ArtefactForm]:
    """Every feature with enough touches."""
    names, counts = np.unique(touches.feature, return_counts=True)
    for name, count in zip(names, counts, strict=True):
        if name and count >= FORM_TOUCHES:
            yield ArtefactForm(str(name))


KIND = Kind.of(
    ArtefactForm,
    title="form error of the standard",
    synonyms="calibration error of the standard, waviness, surface form, artefact form",
    formula="bias = sum a_ij p_i(v) p_j(w)/2, i + j <= 5, Legendre over the touched rectangle",
    units="a_ij: µm",
    typical="0.5 to 2 µm, correlated over 20 to 50 mm",
    source="ISO 25178-2 (form); calibration of freeform standards",
    propose=propose,
    when=lambda touches: touches.instrument.is_ball_on_standard,
)
