"""Which errors a patch is for, and what share of its signal they make."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from matstd.artefact.body import ErrorShare, Standard
from matstd.artefact.reach import Requests
from matstd.artefact.worth.touch_criterion import Criterion
from matstd.information.criteria import whitened
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array
from matstd.twin.machine import Family, parse_symbol
from matstd.twin.model import Effect, Model, traits

ERRORS_PER_PATCH = 4  # errors named for a patch


def with_error_shares(criterion: Criterion, standard: Standard, requests: Requests) -> Standard:
    """The standard with the errors that each patch is for, as touches on its patches see them.

    Raises:
        NotBuildable: Every error has the amplitude zero.
    """
    touches = criterion.reach.touches(requests)
    W = whitened(criterion.model.columns(touches), criterion.model.prior_sd, criterion.noise)
    shares = error_shares(W, requests.feature.tolist(), _symbols(criterion.model))
    patches = tuple(replace(p, errors=shares.get(p.name, ())) for p in standard.patches)
    return replace(standard, patches=patches)


def _symbols(model: Model) -> NDArray[np.str_]:
    """Error parameter (`EXX`, `EC0Y`) that every parameter of a model belongs to, (P,)."""
    return np.array([_symbol(effect) for effect, _ in model.parameters])


def _symbol(effect: Effect) -> str:
    own = traits(effect)
    return own.symbol.name if own.symbol is not None and own.is_ordinary else effect.name


def _is_setup(name: str) -> bool:
    symbol = parse_symbol(name)
    return symbol is not None and symbol.family is Family.SETUP


def error_shares(
    W: Array, patch: Sequence[str], symbols: NDArray[np.str_]
) -> dict[str, tuple[ErrorShare, ...]]:
    """Errors that each patch is for.

    The signal of an error in a patch is the mean square that it is expected to show in the touches
    there; its share is of the sum over all errors of the machine, set-ups left out. Every
    translation shows everywhere, so those are named whose share stands out most against their
    share over all patches together, by ``share log(share / overall share)``. For a single patch
    they are those with the largest share.

    Args:
        W: Whitened rows of all touches on patches, (N, P).
        patch: Name of the feature of every touch, (N,).
        symbols: Error parameter of every column, (P,).

    Raises:
        NotBuildable: Every error has the amplitude zero.
    """
    machine = [p for p, s in enumerate(symbols.tolist()) if not _is_setup(s)]
    names, column = np.unique(symbols[machine], return_inverse=True)
    by_error = np.zeros((len(W), len(names)))
    for p, i in zip(machine, column, strict=True):
        by_error[:, i] += W[:, p] ** 2
    if not by_error.any():
        raise NotBuildable(
            "no error of the machine shows in any patch: the expected amplitudes are all zero"
        )
    labels = np.asarray(patch)
    overall = by_error.mean(axis=0) / by_error.mean(axis=0).sum()
    out = {}
    for name in dict.fromkeys(labels.tolist()):
        mine = by_error[labels == name].mean(axis=0)
        share = mine / mine.sum()
        stands_out = share * np.log(np.maximum(share, 1e-12) / np.maximum(overall, 1e-12))
        if (labels == name).all():  # one patch alone stands out against nothing
            stands_out = share
        best = np.argsort(-stands_out, kind="stable")[:ERRORS_PER_PATCH]
        best = best[np.argsort(-share[best], kind="stable")]
        out[name] = tuple(ErrorShare(str(names[i]), round(float(share[i]), 4)) for i in best)
    return out
