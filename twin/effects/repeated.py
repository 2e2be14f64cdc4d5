"""Effects derived from another: a second one beside it, or its change from some run on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from matstd.twin.model import Effect, Inner, Parameter, Term, Title, Tunable, is_tunable, own_title
from matstd.twin.record import Touches

MARK = "#"
"""Between the name of an effect and which time it stands in the model."""


@dataclass(frozen=True)
class Repeated:
    """An effect with inner parameters of its own, beside one of the same name.

    Only an effect with inner parameters can be in a model twice, because others would be identical.
    """

    original: Tunable  # as if it stood there alone
    repetition: int = 2  # 2 for the second

    @property
    def kind(self) -> str:
        return self.original.kind

    @property
    def name(self) -> str:
        """`thermal-lag(EZZ,bed)#2`."""
        return f"{self.original.name}{MARK}{self.repetition}"

    @property
    def title(self) -> Title:
        return own_title(self.original) or Title(self.original.name)

    @property
    def parameters(self) -> Sequence[Parameter]:
        return self.original.parameters

    def terms(self, touches: Touches) -> Sequence[Term]:
        return self.original.terms(touches)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        return self.original.inner(touches)

    def tuned(self, *values: float) -> "Repeated":
        return replace(self, original=self.original.tuned(*values))

    @property
    def tuning(self) -> Mapping[str, float]:
        return self.original.tuning


def repeat(effect: Effect, number: int = 2) -> Repeated | None:
    """An effect another time, or None where it has no inner parameters to differ in."""
    return Repeated(effect, number) if is_tunable(effect) and effect.tuning else None


@dataclass(frozen=True)
class Change:
    """Change of the parameters of an effect from some run on.

    The effect itself stays in the model and describes the runs before; a change lasts until the
    next one.
    """

    original: Effect  # what changed
    since_run: int  # number of the first run that shows it, as in `Touches.run`
    since: str  # name of that run

    kind = "change"

    @property
    def name(self) -> str:
        """`change(location(EC0Y),autumn)`."""
        return f"change({self.original.name},{self.since})"

    @property
    def title(self) -> Title:
        own = own_title(self.original) or Title(self.original.name)
        return Title(f"change of {own.text}", own.carrier)

    @property
    def parameters(self) -> Sequence[Parameter]:
        return self.original.parameters

    def terms(self, touches: Touches) -> Sequence[Term]:
        here = touches.run >= self.since_run
        return tuple(t._replace(amount=t.amount * here) for t in self.original.terms(touches))
