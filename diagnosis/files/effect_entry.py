"""`[[effect]]` of a model file: an effect, its estimates, and its numbers as reported."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from pydantic import Field

from matstd.diagnosis.fit import Reported, Role
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import Table
from matstd.twin.library import parse_effect
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, is_tunable
from matstd.twin.units import DEG

_INNER_FACTORS = {"": 1.0, "_min": 60.0, "_s": 1.0, "_mm": 1.0, "_deg": DEG}


class ReportedEntry(Table):
    """`[[effect.told]]`: one number of an effect, in the unit that it states."""

    quantity: str
    unit: str = ""
    value: float
    u: float | None = Field(default=None, ge=0.0)
    role: Literal["size", "inner parameter", "coefficient"] = "size"
    bound: Literal[-1, 0, 1] = 0

    def reported(self) -> Reported:
        """The number; its unit in the base unit is not needed any more."""
        return Reported(
            quantity=self.quantity,
            unit=self.unit,
            value=self.value,
            u=self.u,
            factor=1.0,
            role=Role(self.role),
            bound=self.bound,
        )


class EffectEntry(Table):
    """`[[effect]]`: its name, its inner parameters, and the estimates of the others.

    `told` are its numbers as reported of the run, which rest on the touches alone where the
    estimates lean on what is usual. `run` and `share_um` stand at effects that are not the
    machine's: the fingerprint of their run, and the rms that they made at its touches. Of effects
    between which the run does not distinguish each has its `share`, and estimates that are so much
    of what they would be with it alone: together they predict the average.
    """

    name: str
    inner: dict[str, float] = Field(default_factory=dict)
    share: float = Field(default=1.0, gt=0.0, le=1.0)
    estimate: dict[str, float]
    told: list[ReportedEntry] = Field(default_factory=list)
    run: str = ""
    share_um: float = Field(default=0.0, ge=0.0)

    def effect(
        self, chain: Chain, known: Mapping[str, Effect], path: str | Path, key: str
    ) -> Effect:
        """The effect at its inner parameters; raises BadFile, with the key of the entry."""
        try:
            effect = known.get(self.name) or parse_effect(self.name, chain)
        except DesignError as error:
            expected = f"a known effect ({error}); effects of your own are loaded by --effects"
            raise BadFile(path, f"{key}.name", self.name, expected) from error
        if not self.inner:
            return effect
        if not is_tunable(effect) or len(self.inner) != len(effect.tuning):
            expected = ", ".join(effect.tuning) if is_tunable(effect) else "none"
            raise BadFile(path, f"{key}.inner", ", ".join(self.inner), expected)
        values = []
        for (stored, value), name in zip(self.inner.items(), effect.tuning, strict=True):
            suffix = stored.removeprefix(name)
            if suffix == stored or suffix not in _INNER_FACTORS:
                raise BadFile(path, f"{key}.inner", stored, f"{name} with its unit")
            values.append(value * _INNER_FACTORS[suffix])
        return effect.tuned(*values)
