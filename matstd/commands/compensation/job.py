"""What `matstd compensate` begins with: errors of a machine, their state, a datum, a workspace."""

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matstd.compensation.field import Datum, MachineErrors, State, datum_of, workspace
from matstd.compensation.tables import Header, hashed, header_of
from matstd.console import say_each
from matstd.diagnosis.drift import DriftLaw
from matstd.diagnosis.files import read_model
from matstd.diagnosis.remarks import ShortBeam
from matstd.options import load_effects
from matstd.report.words import remark_sentence
from matstd.twin.elastic import short_beams
from matstd.twin.errors import DesignError, UnknownEffect
from matstd.twin.files import parse_toml, read_errors, read_machine, read_text
from matstd.twin.frames import Array
from matstd.twin.library import parse_effect, parse_sized_effect
from matstd.twin.machine import Chain
from matstd.twin.units import DEG, MINUTE


@dataclass(frozen=True, eq=False)
class Job:
    """A machine to be compensated.

    Attributes:
        errors: As they are known, in their state.
        datum: To which everything refers.
        poses: Over which a compensation is judged, (N, A).
        model: Hash of the file, or of the two files, that they were read from.
    """

    errors: MachineErrors
    datum: Datum
    poses: Array
    model: str

    def header(self, sign: int) -> Header:
        """Head of a table."""
        return header_of(self.errors.chain, self.model, self.datum, self.errors.state, sign)


def read_job(args: argparse.Namespace) -> Job:
    """Everything that the command line says of machine, state and datum.

    Raises:
        DesignError: A file or an option that cannot be read, or an active table.
    """
    load_effects(args.effects)
    state = State(
        time=args.after * MINUTE,
        temperature=dict(_numbers("--temperature", args.temperature)),
        spindle_rpm=args.rpm,
        value=dict(_numbers("--value", args.value)),
        force=tuple(args.load),
    )
    with _drives_told(args.model):
        errors = _errors(args, state)
    for text in args.add:
        errors = _with_added(errors, text)
    with _drives_told(args.model):
        errors = _with_unknowns(errors)
    errors = errors.switched(dict(_numbers("--switch", args.switch)))
    if not any(theta.any() for theta in errors.theta):
        raise DesignError(f"{args.model}: no error of an axis is known and switched on")
    chain = errors.chain
    doubtful = short_beams(chain, errors.effects)
    say_each(remark_sentence(ShortBeam(*found)) for found in doubtful)
    files = [args.model] if args.errors is None else [args.model, args.errors]
    files += [effect.path for effect in errors.effects if isinstance(effect, DriftLaw)]
    job = Job(
        errors=errors,
        datum=datum_of(chain, _readings(chain, "--datum", args.datum), args.tool_length),
        poses=workspace(chain, _limits(chain, args.within)),
        model=hashed(b"".join(Path(f).read_bytes() for f in files)),
    )
    for path in args.active:
        Header.of(read_text(path), path).refuse_active(job.header(1), path)
    return job


@contextmanager
def _drives_told(model: str) -> Iterator[None]:
    """Say which options state what a model follows, where something of it is not stated."""
    try:
        yield
    except UnknownEffect as error:
        expected = "expected --temperature, --rpm or --value for all that the model follows"
        raise DesignError(f"{model}: {error}; {expected}") from error


def _with_added(errors: MachineErrors, text: str) -> MachineErrors:
    """With an effect that is added: of the size that is stated, or a saved law as it was saved."""
    if "=" not in text:
        effect = parse_effect(text, errors.chain)
        if isinstance(effect, DriftLaw):
            return errors.with_known([(effect, np.ones(1))])
    added = parse_sized_effect(text, errors.chain)
    return errors.with_known([(added.effect, added.theta)])


def _with_unknowns(errors: MachineErrors) -> MachineErrors:
    """Saved laws with what is not known of them; raises UnknownEffect where a drive is missing."""
    for number, effect in enumerate(errors.effects):
        if isinstance(effect, DriftLaw):
            effect.replay(errors.touches(np.zeros((1, len(errors.chain.axes))), 0.0))
            theta, root = effect.whole.known
            errors = errors.widened(number, effect.whole, theta[1:], root[1:, 1:])
    return errors


def by_tool(option: str, words: Sequence[str]) -> dict[int | str, float]:
    """Lengths or radii of tools by number, or by name in capitals, mm; raises DesignError."""
    return {
        int(name) if name.isdigit() else name.upper(): size
        for name, size in _numbers(option, words)
    }


def _errors(args: argparse.Namespace, state: State) -> MachineErrors:
    """Of a model, or of a machine file with an error file."""
    if parse_toml(read_text(args.model), args.model).get("format") != "machine/1":
        if args.errors is not None:
            raise DesignError(f"--errors {args.errors}: {args.model} has errors of its own")
        saved = read_model(args.model)
        say_each(remark_sentence(one) for one in saved.left_out)
        return MachineErrors.of_model(saved, state)
    if args.errors is None:
        raise DesignError(f"{args.model}: a machine without errors; expected --errors ERRORS.toml")
    chain = read_machine(args.model)
    return MachineErrors.of_errors(chain, read_errors(args.errors, chain), state)


def _numbers(option: str, words: Sequence[str]) -> list[tuple[str, float]]:
    """`NAME=NUMBER` words."""
    out = []
    for word in words:
        name, _, number = word.rpartition("=")
        try:
            out.append((name, float(number)))
        except ValueError:
            name = ""
        if not name or not np.isfinite(out[-1][1]):
            raise DesignError(f"{option} {word}: expected a name and a number, such as X=100")
    return out


def _readings(chain: Chain, option: str, words: Sequence[str]) -> dict[str, float]:
    """Readings by axis, mm and rad, within the travels."""
    out = {}
    for name, value in _numbers(option, words):
        link = chain.links[chain.link_index(chain.axes[chain.axis_index(name)])]
        unit = DEG if link.kind == "rotary" else 1.0
        low, high = link.range
        if not low <= value * unit <= high:
            expected = f"{low / unit:g} to {high / unit:g}, the travel of {name}"
            raise DesignError(f"{option} {name}={value:g}: expected {expected}")
        out[name] = value * unit
    return out


def _limits(chain: Chain, words: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Ranges by axis, mm and rad."""
    out = {}
    for word in words:
        name, _, ends = word.partition("=")
        low, colon, high = ends.partition(":")
        if not colon:
            raise DesignError(f"--within {word}: expected an axis and its ends, such as X=-100:100")
        both = [_readings(chain, "--within", [f"{name}={end}"])[name] for end in (low, high)]
        if not both[0] <= both[1]:
            raise DesignError(f"--within {word}: expected the smaller end first")
        out[name] = (both[0], both[1])
    return out
