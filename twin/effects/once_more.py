"""An effect once more: a second time beside itself, or changed from some run on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from matstd.twin.model import Effect, Inner, Parameter, Term, Title, Titled, Tunable
from matstd.twin.record import Touches

MARK = "#"
"""Between the name of an effect and which time it stands in the model."""


@dataclass(frozen=True)
class Again:
    """An effect with inner parameters of its own, beside one of the same name.

    Only an effect with inner parameters can stand in a model twice: without them both would be one.

    Attributes:
        effect: As if it stood there alone.
        number: 2 for the second.
    """

    effect: Tunable
    number: int = 2

    @property
    def kind(self) -> str:
        """The kind of the effect."""
        return self.effect.kind

    @property
    def name(self) -> str:
        """`thermal-lag(EZZ,bed)#2`."""
        return f"{self.effect.name}{MARK}{self.number}"

    @property
    def title(self) -> Title:
        """That of the effect."""
        return self.effect.title if isinstance(self.effect, Titled) else Title(self.effect.name)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Those of the effect."""
        return self.effect.parameters

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Those of the effect."""
        return self.effect.terms(touches)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """Those of the effect."""
        return self.effect.inner(touches)

    def tuned(self, *values: float) -> "Again":
        """With these values of the inner parameters."""
        return replace(self, effect=self.effect.tuned(*values))

    @property
    def tuning(self) -> Mapping[str, float]:
        """Values of the inner parameters."""
        return self.effect.tuning


def again(effect: Effect, number: int = 2) -> Again | None:
    """An effect another time, or None where it has no inner parameters to differ in."""
    return Again(effect, number) if isinstance(effect, Tunable) and effect.tuning else None


@dataclass(frozen=True)
class Change:
    """By how much the parameters of an effect differ from some run on.

    The effect itself stands in the model beside it and is that of the runs before; what happened
    between two runs stays until the next change.

    Attributes:
        effect: What changed.
        index: Number of the first run that shows it, as in `Touches.run`.
        since: Name of that run.
    """

    effect: Effect
    index: int
    since: str

    kind = "change"

    @property
    def name(self) -> str:
        """`change(location(EC0Y),autumn)`."""
        return f"change({self.effect.name},{self.since})"

    @property
    def title(self) -> Title:
        """That of the effect."""
        own = self.effect.title if isinstance(self.effect, Titled) else Title(self.effect.name)
        return Title(f"change of {own.text}", own.carrier)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Those of the effect: what may be anything may also become anything."""
        return self.effect.parameters

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Those of the effect, at the touches of this run and of later ones."""
        here = touches.run >= self.index
        return tuple(t._replace(amount=t.amount * here) for t in self.effect.terms(touches))
