"""How many sets of effects the searches of one diagnosis may still try."""

from dataclasses import dataclass

MOST_SETS = 1500.0
"""Sets of effects that all searches of one diagnosis may try. A usual run needs a hundred, an
unexplained one three hundred; long records of many related sensors need more, and a remark says so
when the limit ended the search."""

UNIT_CHARGE_SIZE = 5e7
"""Touches times squared columns from which a set counts for more than one."""

USUAL_POOL = 1.3e6
"""Touches times columns of all candidates in a usual run; a set of a small one counts for less."""

MIN_CHARGE = 0.1
"""Least charge of a set."""


@dataclass(slots=True)
class Budget:
    """Number of sets that searches may still try, shared; once spent, they return what they have.

    Attributes:
        left: Number of sets of ordinary size.
    """

    left: float = MOST_SETS

    def spend(self, touches: int, columns: int, pool: int) -> None:
        """Charge for one set, and for all columns of the pool beside it."""
        beside = min(MIN_CHARGE + float(touches) * pool / USUAL_POOL, 1.0)
        self.left -= beside + float(touches) * columns * columns / UNIT_CHARGE_SIZE

    @property
    def is_spent(self) -> bool:
        """Whether some search was ended before its end."""
        return self.left <= 0.0
