"""Every threshold of learning a law, once, with its reason."""

from dataclasses import dataclass

from matstd.diagnosis.policy import POLICY as DIAGNOSIS


@dataclass(frozen=True, slots=True, kw_only=True)
class LawPolicy:
    """What decides whether there is a law, and which."""

    # log evidence charged for choosing one of all carriers, variables and shapes
    tried_singles: float = 8.0
    # the same for a product of two shapes: some hundred times as many are tried
    tried_products: float = 14.0
    # charged for a jump over a temperature: what jumps happens at an instant as a rule, and over a
    # temperature that only rises both are the same
    switch_of_level: float = 4.0
    # charged for a sine of more than eight periods in the range, of which some thousand frequencies
    # are tried, and for a loop over readings, which go to and fro as quickly
    quick: float = 4.0
    # charged for a shape that is met seldom where another has as few parameters: a power or a
    # saturation over time looks like an exponential
    unusual: float = 2.0
    min_score: float = 5.0  # log evidence that a law must gain beyond all charges: odds of 150 : 1
    shorter: float = 2.0  # log evidence below which the shorter of two formulas is taken
    # log odds below which laws form a class, with an effect of the library that explains as well;
    # predictions average over its members
    class_odds: float = 4.0
    # log odds of a law over a temperature, a level or a time since an event against every law that
    # belongs to its run alone, below which it may stand for a driver that was not recorded, as in
    # the choice of effects. Where the driver had been deleted they were 0.2, -0.6, 3.5 and 6.2, of
    # true laws of temperatures 19 and more
    open_driver: float = DIAGNOSIS.log_odds_open_driver
    most_laws: int = 3  # laws learnt one after the other
    most_factors: int = 2  # shapes of which a law is the product
    most_turns: int = 2  # how often each of several laws is searched anew with the others in place
    most_members: int = 6  # most laws over which a prediction averages
    most_rivals: int = 8  # rivals that are reported


POLICY = LawPolicy()
