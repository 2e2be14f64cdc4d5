"""One quantity of a machine's geometry: a value, what was expected, what changed."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.geometry.quantities import Quantity
from matstd.diagnosis.policy import POLICY


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value with its standard uncertainty."""

    value: float
    u: float


@dataclass(frozen=True, slots=True)
class GeometryRow:
    """One quantity of the machine's geometry."""

    quantity: Quantity
    symbol: str  # its ISO 230-1 name, such as EC0Y for the squareness of Y to X
    axes: tuple[str, ...]  # the axis, or the two of a squareness, the reference first
    unit: str  # "mm", "rad", or "1" for a scale
    # in that unit; of a straightness, an angular error or an error motion the peak-to-valley over
    # the probed readings
    estimate: Estimate
    lever: float  # what the estimate is multiplied by to say what it does at the ends, mm per unit
    expected: float  # standard deviation before the run
    is_determined: bool  # whether the run, rather than the expectation, decides it
    # parameters that it cannot be separated from, where it is not determined
    shared_with: tuple[str, ...] = ()
    before: Estimate | None = None  # the same in an earlier model, or in the first of several runs
    # now less before, of a peak to valley between readings that are the same in both; None without
    # a before
    change: Estimate | None = None
    since_model: Estimate | None = None  # the same of the first run less an earlier model
    # the same in every run, in their order, where there are several; None in a run that does not
    # determine it
    course: tuple[Estimate | None, ...] = ()
    # what changed into every run but the first; None where either is not determined
    steps: tuple[Estimate | None, ...] = ()
    # for the line or zero of a rotary axis: usual size of the error that names it
    usual: float | None = None
    # for such a line: standard deviation before the run of what all errors of the machine add up to
    # there. Angles of a linear axis far from its table bend its way
    added_up: float = 0.0
    # of the estimate, what tables and learnt laws contribute; None of a peak to valley, and without
    by_laws: Estimate | None = None
    # what the choice of the model contributes to the uncertainty of the estimate
    u_model: float = 0.0

    @property
    def is_far(self) -> bool:
        """Whether it is a line or zero of a rotary axis far from where the machine file has it."""
        if self.usual is None or not self.is_determined or self._is_added_up:
            return False
        return abs(self.estimate.value) > POLICY.far_line * max(self.usual, self.estimate.u)

    @property
    def times_usual(self) -> float:
        """Size over the usual one of a line or zero of a rotary axis; 0 of other quantities."""
        return abs(self.estimate.value) / self.usual if self.usual else 0.0

    @property
    def at_ends(self) -> Estimate:
        """What it does over the whole travel of its axis, mm."""
        return Estimate(abs(self.estimate.value) * self.lever, self.estimate.u * self.lever)

    @property
    def is_beyond_expected(self) -> bool:
        """Whether it exceeds what such a machine was expected to have by more than chance."""
        bound = POLICY.clear_excess * float(np.hypot(self.expected, self.estimate.u))
        is_beyond = self.is_determined and abs(self.estimate.value) > bound
        return is_beyond and not self._is_added_up

    @property
    def _is_added_up(self) -> bool:
        """Whether ordinary errors of the machine may add up to this line of a rotary axis."""
        return abs(self.estimate.value) <= POLICY.beyond_added_up * self.added_up

    @property
    def has_changed(self) -> bool:
        """Whether it differs from before, or one run from the next, by more than chance."""
        return (self.is_determined and is_clear(self.change)) or any(map(is_clear, self.steps))

    @property
    def has_changed_since_model(self) -> bool:
        """Whether the first run differs from an earlier model by more than chance."""
        is_known = self.course[0] is not None if self.course else self.is_determined
        return is_known and is_clear(self.since_model)

    def has_changed_into(self, run: int) -> bool:
        """Whether it differs from the run before by more than chance; the first run is 0."""
        return run > 0 and is_clear(self.steps[run - 1])


def is_clear(change: Estimate | None) -> bool:
    """Whether a change exceeds chance."""
    return change is not None and abs(change.value) > POLICY.clear_change * change.u
