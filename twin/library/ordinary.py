"""The ordinary geometric model, to which a diagnosis adds what is missing."""

import math

from matstd.twin.effects import ComponentError, LocationError
from matstd.twin.machine import Chain, Family, Ranges, Symbol
from matstd.twin.model import Effect, Model


def component_errors(chain: Chain, symbol: Symbol, sd: float) -> list[Effect]:
    """One component error in the ordinary distributions.

    On a linear axis linear and parabolic over its range, and sinusoidal with free phase (sine and
    cosine, one period over the range); on a rotary axis, whose errors repeat every turn, harmonic 1
    with free phase. A spindle that is not programmed stays at one angle, where an error can only be
    constant.
    """
    link = chain.link(symbol.link)
    if not link.programmed:
        return [ComponentError(symbol, "constant", sd=sd)]
    waves: list[Effect] = [
        ComponentError(symbol, "sinusoidal", sd=sd),
        ComponentError(symbol, "sinusoidal", phase=math.pi / 2.0, sd=sd),
    ]
    if link.kind == "rotary":
        return waves
    return [
        ComponentError(symbol, "linear", sd=sd),
        ComponentError(symbol, "parabolic", sd=sd),
        *waves,
    ]


def ordinary_model(chain: Chain) -> Model:
    """Every component error in its ordinary distributions and every location error.

    Set-ups of the standard are not in it: they belong to a run (`diagnosis`). The prior standard
    deviations are those of amplitudes drawn from the default ranges with random sign.
    """
    effects: list[Effect] = []
    for symbol in chain.symbols:
        sd = Ranges().sd(chain, symbol)
        if symbol.family is Family.COMPONENT:
            effects += component_errors(chain, symbol, sd)
        else:
            effects.append(LocationError(symbol, sd))
    return Model(chain, tuple(effects))
