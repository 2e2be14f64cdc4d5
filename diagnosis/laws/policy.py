"""Every threshold of learning a law, once, with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class LawPolicy:
    """What decides whether there is a law, and which.

    Attributes:
        tried_singles: Log evidence charged for choosing one of all carriers, variables and shapes.
        tried_products: The same for a product of two shapes: some hundred times as many are tried.
        switch_of_level: Charged for a jump over a temperature: what jumps happens at an instant as
            a rule, and over a temperature that only rises both are the same.
        quick: Charged for a sine of more than eight periods in the range, of which some thousand
            frequencies are tried, and for a loop over readings, which go to and fro as quickly.
        unusual: Charged for a shape that is met seldom where another has as few parameters: a power
            or a saturation over time looks like an exponential.
        min_score: Log evidence that a law must gain beyond all charges: odds of 150 : 1.
        shorter: Log evidence below which the shorter of two formulas is taken.
        class_odds: Log odds below which laws form a class; predictions average over its members.
        open_driver: Log odds of a law over a temperature, a level or a time since an event against
            every law that belongs to its run alone, below which it may stand for a driver that was
            not recorded: odds of 150 : 1. Where the driver had been deleted they were 0.2, -0.6 and
            3.5, of true laws of temperatures 19 and more.
        most_laws: Laws learnt one after the other.
        most_turns: How often each of several laws is searched anew with the others in place.
        most_members: Most laws over which a prediction averages.
        most_rivals: Rivals that are reported.
    """

    tried_singles: float = 8.0
    tried_products: float = 14.0
    switch_of_level: float = 4.0
    quick: float = 4.0
    unusual: float = 2.0
    min_score: float = 5.0
    shorter: float = 2.0
    class_odds: float = 4.0
    open_driver: float = 5.0
    most_laws: int = 3
    most_turns: int = 2
    most_members: int = 6
    most_rivals: int = 8


POLICY = LawPolicy()
