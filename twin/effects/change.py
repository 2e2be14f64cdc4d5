"""What an effect changed by between one run of a machine and the next."""

from collections.abc import Sequence
from dataclasses import dataclass

from twin.model import Effect, Parameter, Term, Title, Titled
from twin.record import Touches


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
