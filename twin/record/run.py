"""`Run`: measured deviations of touches, with what the reader of the file noticed."""

import hashlib
from dataclasses import dataclass, field, replace
from datetime import datetime
from typing import Any

import numpy as np

from matstd.twin.display import Displayed
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record.touches import Labels, Touches, check_rows, no_labels, no_numbers
from matstd.twin.units import DEG

PER_ROW = ("deviation", "u", "split", "repeat", "line", "program", "touch", "program_line")
"""Fields of `Run` with a value for each touch."""


FAR_TURN, FAR_SHIFT = 3.0 * DEG, 20.0
"""Turn and displacement (mm) of a standard from where it is stated to stand, beyond which it was
not clamped as planned: one that was put down carelessly stands within 5 mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Moved:
    """A set-up that stands elsewhere than stated."""

    name: str
    shift: float  # displacement of the middle of its touches, mm
    turn: float  # angle of its rotation, rad
    turned: Array  # the same as a vector about which it is, table frame, (3,), rad
    origin: Array  # displacement of the origin of the standard, table frame, (3,), mm

    @property
    def is_far(self) -> bool:
        """Whether the standard was clamped otherwise than planned."""
        return self.turn > FAR_TURN or float(np.linalg.norm(self.origin)) > FAR_SHIFT


@dataclass(frozen=True, eq=False, repr=False)
class Run(Displayed):
    """Measurements: touches with their deviations and standard uncertainties."""

    touches: Touches  # where, when and in which state
    # signed distance along the normal, the growth of the standard taken off, (N,), mm
    deviation: Array
    u: Array  # standard uncertainty of each deviation as stated, (N,), mm
    split: Labels = field(default_factory=no_labels)  # "train", "test" or "" for each row, (N,)
    # number of the repetition, equal points share everything else; None if not recorded
    repeat: IntArray | None = None
    line: IntArray = field(default_factory=no_numbers)  # of each row in its file, (N,)
    remarks: tuple[str, ...] = ()  # what the reader noticed and did about it, one clear line each
    moved: tuple[Moved, ...] = ()  # set-ups that stand elsewhere than the file states
    date: datetime | None = None  # when it began; None where it is not recorded
    standard: str = ""  # name, serial number and digest of the probed one; "" where not recorded
    # name of the probing program that made each touch, (N,); "" where not recorded
    program: Labels = field(default_factory=no_labels)
    touch: IntArray = field(default_factory=no_numbers)  # its number there, (N,); 0 for unknown
    # line of the program on which it begins, (N,); 0 for unknown
    program_line: IntArray = field(default_factory=no_numbers)

    def __post_init__(self) -> None:
        n = len(self.touches)
        defaults = {
            "split": np.full(n, "", dtype="U5"),
            "line": np.arange(1, n + 1),
            "program": np.full(n, "", dtype="U1"),
            "touch": np.zeros(n, dtype=np.int64),
            "program_line": np.zeros(n, dtype=np.int64),
        }
        check_rows(self, n, defaults, PER_ROW, "the touches")

    def __len__(self) -> int:
        return len(self.touches)

    @property
    def raw_deviation(self) -> Array:
        """Deviations from the standard at 20 degC, as they stand in files, (N,), mm."""
        return np.asarray(self.deviation + self.touches.growth)

    @property
    def fingerprint(self) -> str:
        """Short digest of readings, points and deviations: the same run has it whenever read.

        Whatever is stated of the temperature of its standard, it is the same measurement.
        """
        t = self.touches
        digest = hashlib.sha256()
        for values in (t.q, t.point, t.normal, self.raw_deviation):
            digest.update((np.round(values, 9) + 0.0).tobytes())  # + 0.0: no negative zeros
        return digest.hexdigest()[:16]

    @property
    def fingerprints(self) -> tuple[str, ...]:
        """One value for every run that was joined, in their order, and last for all together."""
        of = self.touches.run
        each = [self[of == i].fingerprint for i in np.unique(of)]
        return (*each, self.fingerprint) if len(each) > 1 else (self.fingerprint,)

    def __getitem__(self, rows: Mask | IntArray | slice) -> "Run":
        """The measurements of some rows, as a new record."""
        own = {name: getattr(self, name) for name in PER_ROW}
        picked: dict[str, Any] = {name: None if v is None else v[rows] for name, v in own.items()}
        return replace(self, touches=self.touches[rows], **picked)
