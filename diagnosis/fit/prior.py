"""What is believed of a model's parameters before a run: distributions, or an earlier fit."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from matstd.twin.frames import Array
from matstd.twin.model import Effect


@dataclass(frozen=True, eq=False)
class Prior:
    """Normal distribution of P parameters, ``theta = mean + root phi`` with unit normal phi."""

    mean: Array  # shape (P,), base units
    root: Array  # shape (P, P), any root of the covariance: ``covariance = root root^T``
    # factor on what is expected of the class of machine, in `root` already, (P,); None where there
    # is none
    narrowed: Array | None = None

    @classmethod
    def of_effects(cls, effects: Sequence[Effect]) -> "Prior":
        """Zero on average, independent, with the standard deviations that the effects state."""
        sd = np.array([p.sd for e in effects for p in e.parameters])
        return cls(np.zeros(len(sd)), np.diag(sd))

    @classmethod
    def of_estimates(cls, mean: Array, covariance: Array) -> "Prior":
        """An earlier fit; a covariance that rounding has left slightly indefinite is mended."""
        sd = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        values, vectors = np.linalg.eigh(covariance / np.outer(sd, sd))
        root = vectors * np.sqrt(np.maximum(values, 1e-14))
        return cls(np.array(mean, dtype=float), sd[:, None] * root)

    def __len__(self) -> int:
        return len(self.mean)

    @property
    def sd(self) -> Array:
        """Standard deviation of every parameter, (P,)."""
        return np.sqrt(np.einsum("pk,pk->p", self.root, self.root))

    @property
    def factor(self) -> Array:
        """On what is expected of the class of machine, (P,)."""
        return np.ones(len(self)) if self.narrowed is None else self.narrowed

    @property
    def expected(self) -> Array:
        """Standard deviations as the class of machine has them, (P,)."""
        return self.sd / self.factor

    def widened(self, factor: float) -> "Prior":
        """The same belief, held with less confidence."""
        return Prior(self.mean, factor * self.root, self.narrowed)

    def at_least(self, other: "Prior") -> "Prior":
        """The same belief in the class, narrowed no more than another one is."""
        factor = np.maximum(self.factor, other.factor)
        return Prior(self.mean, (factor / self.factor)[:, None] * self.root, factor)

    def joined(self, other: "Prior") -> "Prior":
        """Both sets of parameters, independent of one another."""
        root = block_diag(self.root, other.root)
        narrowed = None
        if self.narrowed is not None or other.narrowed is not None:
            narrowed = np.concatenate([self.factor, other.factor])
        return Prior(np.concatenate([self.mean, other.mean]), root, narrowed)
