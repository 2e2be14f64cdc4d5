"""The errors of a machine as a diagnosis, a model or an error file knows them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

from matstd.api.diagnosing import Diagnosis
from matstd.compensation.field import MachineErrors, State
from matstd.diagnosis.files import SavedModel, model_of, read_model
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.remarks import Remark
from matstd.twin.errors import BadArgument, DesignError, UnknownEffect
from matstd.twin.files import kind_of, read_errors, read_machine, read_text
from matstd.twin.library import parse_effect, parse_sized_effect
from matstd.twin.model import is_saved


class KnownErrors(NamedTuple):
    """Errors of a machine as a model, a diagnosis or an error file states them."""

    errors: MachineErrors
    remarks: tuple[Remark, ...]  # on the model
    content: bytes  # that tables have a hash of
    probes: tuple[float, ...] = ()  # lengths of the probes that touched, mm


def machine_errors(
    model: Diagnosis | Fit | SavedModel | str | Path, errors: str | Path | None, state: State
) -> KnownErrors:
    """Errors of a machine at a state of it."""
    if errors is not None and not isinstance(model, str | Path):
        raise BadArgument("errors", errors, "none: the model has errors of its own")
    if isinstance(model, Diagnosis):
        return _of_model(model.model, (), model.model_text.encode(), state)
    if isinstance(model, Fit):
        model = model_of(model)
    if isinstance(model, SavedModel):
        known = model.estimates.mean.tobytes() + model.estimates.root.tobytes()
        return _of_model(model, model.left_out, known, state)
    content = Path(model).read_bytes if errors is None else None
    if kind_of(read_text(model)) != "machine":
        if content is None:
            raise BadArgument("errors", errors, f"none: {model} has errors of its own")
        saved = read_model(model)
        return _of_model(saved, saved.left_out, content(), state)
    if errors is None:
        raise DesignError(f"{model}: a machine without errors; expected --errors ERRORS.toml")
    chain = read_machine(model)
    found = MachineErrors.of_errors(chain, read_errors(errors, chain), state)
    return KnownErrors(found, (), Path(model).read_bytes() + Path(errors).read_bytes())


def _of_model(
    model: SavedModel, remarks: tuple[Remark, ...], content: bytes, state: State
) -> KnownErrors:
    """Errors of a model, with the probes that it was learnt with."""
    lengths = tuple(dict.fromkeys(probe[0] for probe in model.source.probes))
    return KnownErrors(MachineErrors.of_model(model, state), remarks, content, lengths)


@contextmanager
def drives_stated(model: str) -> Iterator[None]:
    """Say which options state what a model follows, where something of it is not stated."""
    try:
        yield
    except UnknownEffect as error:
        expected = (
            "expected --temperature, --rpm or --value for all that the model follows, in Python "
            "State(temperature=..., spindle_rpm=..., value=...)"
        )
        raise DesignError(
            f"{model}: {str(error).removesuffix('; there is none')}; {expected}"
        ) from error


def with_added(errors: MachineErrors, text: str) -> MachineErrors:
    """With an effect that is added: of the size that is stated, or a saved law as it was saved."""
    if "=" not in text:
        effect = parse_effect(text, errors.chain)
        if is_saved(effect):
            return errors.with_known([(effect, np.ones(1))])
    added = parse_sized_effect(text, errors.chain)
    return errors.with_known([(added.effect, added.theta)])


def with_unknowns(errors: MachineErrors) -> MachineErrors:
    """Saved laws with what is not known of them; raises UnknownEffect where a drive is missing."""
    for number, effect in enumerate(errors.effects):
        if is_saved(effect):
            effect.terms(errors.touches(np.zeros((1, len(errors.chain.axes))), 0.0))
            theta, root = effect.whole.known
            errors = errors.widened(number, effect.whole, theta[1:], root[1:, 1:])
    return errors
