"""What is usual of a quantity of the geometry, before a run: of its axis, else of its class."""

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry.quantities import geometric_effects
from matstd.twin.frames import Array
from matstd.twin.model import traits


def expected_size(fit: Fit, weights: Array, stated: Array) -> float:
    """Standard deviation before the run, as the axis or the class of the machine has it.

    Args:
        weights: Weights of the parameters, (P,).
        stated: `stated_sizes` of the fit.
    """
    part = slice(len(weights))
    sd = (weights / fit.prior.factor[part] / fit.widened) @ fit.prior.root[part, part]
    return float(np.linalg.norm(sd * stated))


def stated_sizes(fit: Fit) -> Array:
    """What the machine file expects of every parameter over what its class has, (P,)."""
    out = np.ones(len(fit.model.parameters))
    for start, effect in geometric_effects(fit):
        symbol = traits(effect).ordinary_component
        if symbol is not None and not symbol.is_angular:
            expected = fit.model.chain.link(symbol.link).expected
            if expected is not None:
                sizes = [p.sd for p in effect.parameters]
                out[start : start + len(sizes)] = expected / np.array(sizes)
    return out
