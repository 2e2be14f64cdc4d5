"""The neural network of the third paper: temperatures in, all drifts out, one hidden layer.

Reference: Chen, J. S. 1995 (23 thermocouples, five drifts of the spindle).
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from matstd.diagnosis.drift.linear import memory_of, standardised
from matstd.diagnosis.drift.record import DriftRecord, IntArray
from matstd.twin.errors import MissingLibrary
from matstd.twin.frames import Array

HIDDEN = 10
"""Nodes of the hidden layer."""

PENALTIES = (0.03, 0.3, 3.0, 30.0)
"""On squared weights, of which the one is taken that predicts left-out blocks best."""

MEMBERS = 5
"""Networks that are trained from different beginnings; their mean is the prediction."""

ROWS = 400
"""Rows that a network is trained with: a drift is slow, more of them say the same again."""

EPOCHS = 300
SEED = 1995


@dataclass(frozen=True, eq=False)
class Network:
    """The mean of several networks with one hidden layer, tanh.

    Attributes:
        drives: Its inputs.
        mean: Of the drives in training, (D,).
        scale: Their standard deviations, (D,).
        center: Of the displacements, (K,), base units.
        spread: Of the displacements, (K,).
        weights: Of every member: into the hidden layer (D, H), its thresholds (H,), out of it
            (H, K), thresholds of the output (K,).
        residual: Standard deviation of what is left in training, (K,).
        memory: Time in which what is left forgets itself, s.
    """

    drives: tuple[str, ...]
    mean: Array
    scale: Array
    center: Array
    spread: Array
    weights: tuple[tuple[Array, Array, Array, Array], ...]
    residual: Array
    memory: float

    def predicted(self, record: DriftRecord) -> Array:
        """From the drives at once, (N, K)."""
        Z = (record.columns(self.drives) - self.mean) / self.scale
        out = [np.tanh(Z @ V + v) @ W + w for V, v, W, w in self.weights]
        return self.center + self.spread * np.mean(out, axis=0)

    def leverage(self, record: DriftRecord) -> Array:
        """Not known, so nothing, (N,)."""
        return np.zeros(len(record))


def network(record: DriftRecord, parts: Sequence[IntArray]) -> Network:
    """Networks with the penalty that predicts left-out blocks best.

    Raises:
        MissingLibrary: scikit-learn is not installed.
    """
    thinned = [b[:: max(1, sum(map(len, parts)) // ROWS)] for b in parts]
    errors = []
    for penalty in PENALTIES:
        total = 0.0
        for i, part in enumerate(thinned):
            others = np.concatenate([b for j, b in enumerate(thinned) if j != i])
            own = _trained(record, others, penalty, 1)
            left = (own.predicted(record)[part] - record.displacement[part]) / record.size
            total += float((left**2).sum())
        errors.append(total)
    best = PENALTIES[int(np.argmin(errors))]
    return _trained(record, np.concatenate(thinned), best, MEMBERS)


def _trained(record: DriftRecord, rows: IntArray, penalty: float, members: int) -> Network:
    Z, mean, scale = standardised(record.drive, rows)
    y = record.displacement[rows]
    center, spread = y.mean(axis=0), np.maximum(y.std(axis=0), 1e-12)
    weights = tuple(_one(Z[rows], (y - center) / spread, penalty, SEED + k) for k in range(members))
    law = Network(
        drives=record.drives,
        mean=mean,
        scale=scale,
        center=center,
        spread=spread,
        weights=weights,
        residual=np.zeros(len(center)),
        memory=record.step,
    )
    left = y - law.predicted(record)[rows]
    pace = record.step * max(1, round(float(np.median(np.diff(rows)))))
    memory = memory_of(left / record.size, pace)
    return replace(law, residual=left.std(axis=0), memory=memory)


def _one(X: Array, Y: Array, penalty: float, seed: int) -> tuple[Array, Array, Array, Array]:
    """Weights of one network; its training may stop before it is at its end, on purpose."""
    regressor = _regressor()(
        hidden_layer_sizes=(HIDDEN,),
        activation="tanh",
        solver="lbfgs",
        alpha=penalty,
        max_iter=EPOCHS,
        random_state=seed,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        regressor.fit(X, Y if Y.shape[1] > 1 else Y[:, 0])
    (V, W), (v, w) = regressor.coefs_, regressor.intercepts_
    return V, v, W, w


def has_network() -> bool:
    """Whether scikit-learn is installed."""
    from importlib.util import find_spec

    return find_spec("sklearn") is not None


def _regressor() -> Any:
    try:
        from sklearn.neural_network import MLPRegressor
    except ImportError as error:
        raise MissingLibrary(
            "the neural network needs scikit-learn: pip install 'material-standard[network]'"
        ) from error
    return MLPRegressor
