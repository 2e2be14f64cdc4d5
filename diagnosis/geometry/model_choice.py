"""How much of a quantity rests on the distributions that a model assumes between the touches.

The run is solved again with fewer and with more distributions of the errors of linear axes; every
model counts by its evidence. The estimate stays; the mean square of the others about it is added to
the square of its uncertainty.

Reference:
    Draper, J. R. Statist. Soc. B 57 (1995) 45 (uncertainty of the choice of a model).
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import softmax

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry.changes import changed_since
from matstd.diagnosis.geometry.functionals import squarenesses
from matstd.diagnosis.geometry.quantities import Quantity
from matstd.diagnosis.geometry.rows import Estimate, GeometryRow
from matstd.twin.frames import Array, Mask
from matstd.twin.library import parse_effect
from matstd.twin.machine import Symbol
from matstd.twin.model import Model, columns, traits

HIGHER = "3-4"
"""Degrees of polynomials that are added to the straightness and positioning of linear axes."""


def with_model_choice(fit: Fit, rows: Sequence[GeometryRow]) -> tuple[GeometryRow, ...]:
    """Rows whose squareness has what the choice of the model adds to its uncertainty.

    Of several runs with changes between them, and of a fit whose prior ties parameters together,
    the models of the parts are not compared.
    """
    wanted = {r.symbol for r in rows if r.quantity is Quantity.SQUARENESS and r.is_determined}
    if not wanted or changed_since(fit.model) or not _is_diagonal(fit.prior.root):
        return tuple(rows)
    spread = _spreads(fit)
    return tuple(
        _widened(row, spread[row.symbol])
        if row.quantity is Quantity.SQUARENESS and row.symbol in spread
        else row
        for row in rows
    )


def _widened(row: GeometryRow, u_model: float) -> GeometryRow:
    u = float(np.hypot(row.estimate.u, u_model))
    return replace(row, estimate=Estimate(row.estimate.value, u), u_model=u_model)


def _spreads(fit: Fit) -> dict[str, float]:
    """Root mean square of every squareness by other models about that of the fit, rad."""
    more = [parse_effect(f"geometric({s.name},{HIGHER})", fit.model.chain) for s in _symbols(fit)]
    sizes = fit.widened * np.array([p.sd for e in more for p in e.parameters])
    added = columns(more, fit.run.touches)[fit.used] * sizes / fit.u[fit.used][:, None]
    if fit.whitener is not None:
        added = fit.whitener.filtered(added)
    X = np.hstack([fit.X[fit.used], added / fit.weight])
    own = np.arange(X.shape[1]) < fit.X.shape[1]
    sine = np.zeros(X.shape[1], dtype=bool)
    sine[_sines(fit)] = True
    models = [own, own & ~sine, np.ones_like(own), ~sine]
    evidence, theta = zip(*_solved(X, fit.y[fit.used], models), strict=True)
    share = softmax(np.array(evidence))

    machine = len(fit.model.parameters)
    wide = replace(fit, model=Model(fit.model.chain, (*fit.model.effects, *more)))
    place = np.r_[0:machine, fit.X.shape[1] : X.shape[1]]
    scale = np.concatenate([np.diag(fit.prior.root)[:machine], sizes])
    mean = np.concatenate([fit.prior.mean[:machine], np.zeros(len(sizes))])
    every = [mean + scale * phi[place] for phi in theta]
    out = {}
    for one in squarenesses(wide):
        values = np.array([one.weights @ each for each in every])
        out[one.symbol] = float(np.sqrt(share @ (values - values[0]) ** 2))
    return out


def _solved(X: Array, y: Array, models: Sequence[Mask]) -> Iterator[tuple[float, Array]]:
    """Log evidence and estimates of models that have some of the columns.

    Of ``y = X phi`` with unit noise and unit prior: ``-(log det M + y.y - phi.X'y) / 2`` with ``M =
    X'X + 1`` and ``M phi = X'y``.
    """
    M, b = X.T @ X + np.eye(X.shape[1]), X.T @ y
    for model in models:
        chol = cho_factor(M[np.ix_(model, model)])
        phi = np.zeros(X.shape[1])
        phi[model] = cho_solve(chol, b[model])
        log_det = 2.0 * float(np.log(np.diag(chol[0])).sum())
        yield 0.5 * (float(phi @ b) - log_det), phi


def _symbols(fit: Fit) -> list[Symbol]:
    """Translational errors of the linear axes in the model, each once."""
    found = (traits(e).ordinary_component for e in fit.model.effects)
    return list(dict.fromkeys(s for s in found if s and not s.is_angular and _is_linear(fit, s)))


def _sines(fit: Fit) -> list[int]:
    """Parameters of the sinusoidal distributions of linear axes."""
    out: list[int] = []
    start = 0
    for effect in fit.model.effects:
        symbol = traits(effect).ordinary_component
        stop = start + len(effect.parameters)
        if symbol and _is_linear(fit, symbol) and traits(effect).distribution == "sinusoidal":
            out += range(start, stop)
        start = stop
    return out


def _is_linear(fit: Fit, symbol: Symbol) -> bool:
    return fit.model.chain.link(symbol.link).kind == "linear"


def _is_diagonal(root: Array) -> bool:
    return not np.any(root - np.diag(np.diag(root)))
