"""Colours of all pictures, in two and three dimensions."""

INK, SOFT, LINE, WASH = "#1c2430", "#7d8794", "#d8dee6", "#f4f6f9"
"""Letters, what stands back, grids, and the ground of what is bare."""

FAINT, NEUTRAL = "#9aa4b1", "#c3cad3"
"""Single touches behind their means; bars of what is not singled out."""

BLUE, ORANGE, GREEN, RED, PURPLE = "#0072b2", "#e69f00", "#009e73", "#d55e00", "#aa4499"

_SERIES = (
    BLUE, ORANGE, GREEN, PURPLE, RED, "#56b4e9",
    "#8c564b", "#999933", "#44546a", "#e78ac3", "#117733", "#b2abd2",
)  # fmt: skip
"""The first six are Okabe and Ito's, distinguishable by colour-blind readers; more than twelve
are not distinguishable."""

DIVERGING = "RdBu_r"
"""Map for signed values: red outside, blue inside, white nothing."""

_STEP = 0.3  # towards white or black, at every turn of the twelve colours


def series(k: int) -> str:
    """Colour of the k-th of several things, from 0; a different one for each of sixty.

    Example:
        >>> series(0)
        '#0072b2'
        >>> len({series(k) for k in range(60)})
        60
    """
    turn, place = divmod(k, len(_SERIES))
    if turn == 0:
        return _SERIES[place]
    # lighter, darker, much lighter, much darker ...
    ground = 255.0 if turn % 2 else 0.0
    share = 1.0 - (1.0 - _STEP) ** ((turn + 1) // 2)
    plain = (int(_SERIES[place][i : i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{round(v + share * (ground - v)):02x}" for v in plain)
