"""Model file (TOML, "model/2"): a machine, its effects, and what was learnt of their parameters."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from matstd.diagnosis.accuracy import Promise
from matstd.diagnosis.files.curve_table import CurveEntry
from matstd.diagnosis.files.determined import Determined, DeterminedEntry
from matstd.diagnosis.files.effect_entry import EffectEntry
from matstd.diagnosis.files.unknown_elsewhere import judged_laws, kept_law, unknown_elsewhere
from matstd.diagnosis.fit import Learnt, Prior, Reported, file_unit
from matstd.diagnosis.regression import Memory
from matstd.diagnosis.remarks import EffectOfOtherRun
from matstd.twin.display import Displayed
from matstd.twin.errors import BadFile
from matstd.twin.files import MachineTables, Table, checked, parse_kind, read_text
from matstd.twin.frames import Array
from matstd.twin.library import owner_of
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, Model
from matstd.twin.record import Run, Touches, without_copies
from matstd.twin.units import UM

FORMAT, OLDER = "model/2", "model/1"
"""Version that is written, and one that is read: it has no hash of its machine."""

LARGEST_VARIANCE, SMALLEST_VARIANCE = 1e12, 1e-300
"""Variances of a file beyond the first (µm, µrad squared ...) are slips; of none below the second a
root is taken."""

MAX_ROUNDING = 1e-6
"""By so much rounding may leave correlations of a file beyond one, or variances below zero."""


class MemoryEntry(Table):
    """`[source.memory]`: what the noise of the run remembered."""

    correlation: float = Field(gt=0.0, lt=1.0)
    step_s: float = Field(default=0.0, ge=0.0)
    by_place: bool = False
    is_filtered: bool = True


class SourceEntry(Table):
    """`[source]`: what the estimates rest upon.

    `revision` counts the runs that the model has learnt from, one after the other; `learnt_from`
    has their fingerprints, so that no touch is counted twice. `held_out_um` is the plain error that
    the model promises for the same touches in another run, `elsewhere_um` that at other places; 0
    where it promises none. `probes` are lengths and
    radii of the probes that touched, mm. `machine_hash` is the digest of the machine that was
    measured; "" in "model/1". `began` and `standard` are those of the run.
    """

    run: str
    touches: int
    noise_um: float
    gross_errors: list[int] = Field(default_factory=list)
    revision: int = 1
    learnt_from: list[str] = Field(default_factory=list)
    made_with: str = ""
    held_out_um: float = 0.0
    elsewhere_um: float = 0.0
    held_out_gross_errors: list[int] = Field(default_factory=list)
    memory: MemoryEntry | None = None
    probes: list[Annotated[list[float], Field(min_length=2, max_length=2)]] = Field(
        default_factory=list
    )
    machine_hash: str = ""
    began: datetime | None = None
    standard: str = ""

    @property
    def promise(self) -> Promise | None:
        """The errors that the model promises; None for none."""
        same, elsewhere = self.held_out_um * UM, self.elsewhere_um * UM
        return Promise(same, max(same, elsewhere), ()) if same > 0.0 else None


class ModelTable(Table):
    """The whole file."""

    format: str
    machine: MachineTables
    source: SourceEntry
    effect: list[EffectEntry]
    covariance: list[list[float]]
    curve: list[CurveEntry] = Field(default_factory=list)
    from_inner: list[list[float]] = Field(default_factory=list)
    determined: list[DeterminedEntry] = Field(default_factory=list)


@dataclass(frozen=True, eq=False, repr=False)
class SavedModel(Displayed):
    """A model with what is known of its parameters.

    Attributes:
        estimates: Estimates of the parameters, with their covariance.
        from_inner: Root (P, T) of the part of the covariance that uncertain inner parameters add.
        reported: Numbers of effects as reported of that run, by name.
        determined: What that run determines of the geometry, as it was reported.
        left_out: What the file has beside that and is not to be applied here.
        repeated: Laws of another run that the touches of this one show, too; they are applied.
        refuted: Laws of the machine that the touches of this run speak against: zero is expected of
            them, as unsure as they are large.
    """

    model: Model  # chain and effects
    estimates: Prior
    source: SourceEntry  # from which runs it was learnt, with which tool
    from_inner: Array
    reported: dict[str, tuple[Reported, ...]]
    determined: tuple[Determined, ...] = ()
    left_out: tuple[EffectOfOtherRun, ...] = ()
    repeated: tuple[EffectOfOtherRun, ...] = ()
    refuted: tuple[EffectOfOtherRun, ...] = ()

    @property
    def of_other_runs(self) -> tuple[EffectOfOtherRun, ...]:
        """All that is to be said of what was learnt from other runs."""
        return (*self.left_out, *self.repeated, *self.refuted)

    def doubting(self, refuted: Sequence[EffectOfOtherRun]) -> "SavedModel":
        """The model with zero instead of some laws, as unsure as they are large."""
        names = {one.effect.name for one in refuted}
        if not names:
            return self
        is_own = np.array([e.name in names for e, _ in self.model.parameters])
        root = np.where(is_own[:, None], 0.0, self.estimates.root)
        covariance = root @ root.T + np.diag(np.where(is_own, self.estimates.mean, 0.0) ** 2)
        return replace(
            self,
            estimates=Prior.of_estimates(np.where(is_own, 0.0, self.estimates.mean), covariance),
            from_inner=np.where(is_own[:, None], 0.0, self.from_inner),
            refuted=tuple(refuted),
        )

    def without(self, left_out: Sequence[EffectOfOtherRun]) -> "SavedModel":
        """The model without some effects; what their drivers may do is in their place."""
        names = {one.effect.name for one in left_out}
        if not names:
            return self
        kept = np.array([e.name not in names for e, _ in self.model.parameters])
        root = self.estimates.root[kept]
        known = Prior.of_estimates(self.estimates.mean[kept], root @ root.T)
        margins = unknown_elsewhere(self.model, self.estimates.mean, left_out)
        unknown = Prior.of_effects(margins)
        effects = [e for e in self.model.effects if e.name not in names]
        return replace(
            self,
            model=Model(self.model.chain, (*effects, *margins)),
            estimates=known.joined(unknown),
            from_inner=np.pad(self.from_inner[kept], ((0, len(unknown)), (0, 0))),
            reported={name: said for name, said in self.reported.items() if name not in names},
            left_out=tuple(left_out),
        )

    def learnt(self, run: Run) -> Learnt | None:
        """What the fit to a run is made again from; None where the last run was another."""
        if not self.source.learnt_from or self.source.learnt_from[-1] != run.fingerprint:
            return None
        whole = self.estimates.root @ self.estimates.root.T
        held = whole - self.from_inner @ self.from_inner.T
        source = self.source
        lines = [*source.gross_errors, *source.held_out_gross_errors]
        m = source.memory
        return Learnt(
            estimates=Prior.of_estimates(self.estimates.mean, held),
            from_inner=self.from_inner,
            factor=source.noise_um * UM / float(np.median(run.u)),
            gross=np.isin(run.line, lines),
            memory=Memory(m.correlation, m.step_s, m.by_place, m.is_filtered) if m else None,
        )


def parameter_keys(effect: Effect) -> list[tuple[str, float]]:
    """Key of every linear parameter in files, and one of its unit in the base unit."""
    out = []
    for parameter in effect.parameters:
        suffix, factor = file_unit(parameter.unit)
        out.append((f"{parameter.name.replace(' ', '_')}_{suffix}", factor))
    return out


def check_machine(saved: SavedModel, chain: Chain, path: str | Path) -> None:
    """Refuse a model of another machine than the one that was measured.

    Raises:
        BadFile: Key, what the model has, what the machine of the run has.
    """
    found = saved.model.chain.difference(chain)
    if found is not None:
        key, here, there = found
        way = (
            "; of lists that import drafted a machine for each, give all of them the first one's "
            "by --machine"
            if key.endswith("range")
            else ""
        )
        raise BadFile(path, f"machine.{key}", here, f"{there}, as of the machine of the run{way}")


def read_model(
    path: str | Path, known: Sequence[Effect] = (), runs: Sequence[Run] = ()
) -> SavedModel:
    """Model with its estimates, as far as it is to be applied to some runs.

    A slip, a drift or a jump happened in the run that it was learnt from: it is in the model only
    where that is the run. What belongs to a probe is in it where a run has the same probe, a learnt
    law where the touches of one run show it, too.

    Args:
        known: Effects whose names the library cannot read back, such as those with a prior of a
            project's own; others are made from their names.
        runs: Runs to which the model is applied, each alone; with none, the machine's part remains.

    Raises:
        BadFile: File, key, what stood there, what was expected.
    """
    return parsed_model(read_text(path), path, known, runs)


def parsed_model(
    text: str, path: str | Path, known: Sequence[Effect] = (), runs: Sequence[Run] = ()
) -> SavedModel:
    """The model of a text; arguments and errors as of `read_model`."""
    data = parse_kind(text, path, OLDER if f'"{OLDER}"' in text else FORMAT)
    table = checked(ModelTable, data, path)
    chain = table.machine.made(path, "machine")
    _check_hash(table.source, chain, path)
    by_name = {e.name: e for e in known}
    effects, mean, factors = [], [], []
    for i, entry in enumerate(table.effect):
        effect = entry.effect(chain, by_name, path, f"effect[{i}]")
        effect = kept_law(effect, bool(entry.run))
        keys = parameter_keys(effect)
        expected = [key for key, _ in keys]
        # the covariance has no names, so the order of the estimates must be exact
        if list(entry.estimate) != expected:
            found = ", ".join(entry.estimate)
            raise BadFile(path, f"effect[{i}].estimate", found, ", ".join(expected))
        effects.append(effect)
        mean += [entry.estimate[key] * factor for key, factor in keys]
        factors += [factor for _, factor in keys]
    covariance = covariance_of(table.covariance, np.array(factors), path)
    model = Model(chain, tuple(effects))
    whole = SavedModel(
        model=model,
        estimates=Prior.of_estimates(np.array(mean), covariance),
        source=table.source,
        from_inner=_from_inner(table.from_inner, np.array(factors), path),
        reported={entry.name: tuple(t.reported() for t in entry.told) for entry in table.effect},
        determined=tuple(entry.determined() for entry in table.determined),
    )
    seen = [without_copies(run) for run in runs]
    others = list(_of_others(table, effects, seen))
    if len(seen) != 1:
        return whole.without(others)
    learnt_in = "" if seen[0].fingerprint in table.source.learnt_from else table.source.run
    repeated, refuted = judged_laws(model, whole.estimates.mean, others, seen[0], learnt_in)
    names = {one.effect.name for one in repeated}
    rest = [one for one in others if one.effect.name not in names]
    return replace(whole, repeated=repeated).without(rest).doubting(refuted)


def _check_hash(source: SourceEntry, chain: Chain, path: str | Path) -> None:
    """Refuse a model whose machine was changed after it was learnt.

    Estimates belong to the travels, points and directions that they were learnt with: an axis that
    turns the other way has all its errors with another sign.
    """
    if source.machine_hash and source.machine_hash != chain.fingerprint:
        raise BadFile(
            path,
            "machine",
            f"a machine with the hash {chain.fingerprint}",
            f"that which was measured ({source.machine_hash}); the description was changed after "
            "the model was learnt: change the machine file of the run and diagnose it again",
        )


def probes_of(touches: Touches) -> list[tuple[float, float]]:
    """Lengths and radii of the probes that touched, mm, as a model file has them."""
    if not touches.instrument.is_ball_on_standard:
        return []
    pairs = zip(touches.length.tolist(), touches.radius.tolist(), strict=True)
    return sorted({(round(length, 6), round(radius, 6)) for length, radius in pairs})


def _of_others(
    table: ModelTable, effects: Sequence[Effect], runs: Sequence[Run]
) -> Iterator[EffectOfOtherRun]:
    """Effects of a file that are not to be applied to some runs.

    A file that does not say which run an effect is of has it of the last that it was learnt from.
    """
    source, prints = table.source, {run.fingerprint for run in runs}
    touched = {probe for run in runs for probe in probes_of(run.touches)}
    is_probe = bool(touched) and touched <= {(p[0], p[-1]) for p in source.probes}
    last = source.learnt_from[-1] if source.learnt_from else ""
    for entry, effect in zip(table.effect, effects, strict=True):
        owner = owner_of(effect)
        is_here = prints == {entry.run or last} or (owner == "probe" and is_probe)
        if owner != "machine" and not is_here:
            yield EffectOfOtherRun(
                effect=effect,
                owner=owner,
                inner=entry.inner,
                run=source.run,
                share=entry.share_um * UM,
            )


def _from_inner(rows: list[list[float]], factors: Array, path: str | Path) -> Array:
    """Root of the part of inner parameters in base units, (P, T)."""
    if not rows:
        return np.zeros((len(factors), 0))
    if len(rows) != len(factors) or len({len(row) for row in rows}) > 1:
        raise BadFile(
            path,
            "from_inner",
            f"{len(rows)} rows",
            f"a row of equal length a parameter of {len(factors)}",
        )
    return np.array(rows, dtype=float) * factors[:, None]


def covariance_of(rows: list[list[float]], factors: Array, path: str | Path) -> Array:
    """Covariance in base units from its lower triangle."""
    n = len(factors)
    if [len(row) for row in rows] != list(range(1, n + 1)):
        raise BadFile(
            path, "covariance", f"{len(rows)} rows", f"the lower triangle of {n} parameters"
        )
    out = np.zeros((n, n))
    for i, row in enumerate(rows):
        out[i, : i + 1] = row
        out[: i + 1, i] = row
    _check_covariance(out, path)
    return np.asarray(out * np.outer(factors, factors))


def _check_covariance(matrix: Array, path: str | Path) -> None:
    """Refuse numbers that no covariance has: correlations beyond one, variances below zero."""
    variance = np.diag(matrix)
    wrong = np.flatnonzero(~((variance >= 0.0) & (variance < LARGEST_VARIANCE)))
    if len(wrong):
        i = int(wrong[0])
        raise BadFile(path, f"covariance[{i}][{i}]", matrix[i, i], "a variance")
    sd = np.sqrt(np.maximum(variance, SMALLEST_VARIANCE))
    correlation = matrix / np.outer(sd, sd)
    if np.abs(correlation).max(initial=0.0) > 1.0 + MAX_ROUNDING:
        i, j = (int(k) for k in np.argwhere(np.abs(correlation) > 1.0 + MAX_ROUNDING)[0])
        expected = "a covariance within what the two variances allow"
        raise BadFile(path, f"covariance[{max(i, j)}][{min(i, j)}]", matrix[i, j], expected)
    if np.linalg.eigvalsh(correlation).min(initial=0.0) < -MAX_ROUNDING * len(matrix):
        raise BadFile(path, "covariance", "variances below zero of sums", "a covariance")
