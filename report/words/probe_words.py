"""Words of plans and probing programs."""

from probe_paths.campaign import Ordering

_ORDERINGS = {
    Ordering.AS_PLANNED: "as planned: mixed, twice, from both sides, anchor touches",
    Ordering.WITHOUT_ANCHORS: "the same without the anchor touches",
    Ordering.ONCE: "mixed, every pose once",
    Ordering.SHORTEST: "shortest ways, every pose once, from whichever side",
}


def ordering_words(ordering: Ordering) -> str:
    """How touches were put in order, as a row of a table begins."""
    return _ORDERINGS[ordering]
