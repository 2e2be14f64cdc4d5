"""A process that answers in milliseconds although Python works beside it."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

SWITCH = 0.0005
"""After which a thread that works out tables or uncertainties gives way, s; Python's own 5 ms would
be waited for at every answer."""


@contextmanager
def prompt() -> Iterator[None]:
    """Yield quickly, and keep present objects out of garbage collection.

    The address space of an OPC UA server alone has some 100 000 objects, which a full collection
    looks through for tens of milliseconds.
    """
    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH)
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
        sys.setswitchinterval(before)
