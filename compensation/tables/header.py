"""What every table says of itself, and the refusal of one that is not for this machine."""

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

from matstd.compensation.field import Datum, State
from matstd.twin.errors import BadFile
from matstd.twin.machine import Chain
from matstd.twin.units import MINUTE

_LINE = re.compile(r"\W*(matstd (?:[a-z ]+)): (.*?)\s*\)?\Z")


@dataclass(frozen=True, slots=True)
class Header:
    """Head of a table, in comment lines of its format."""

    model: str
    machine: str  # name of the machine and hash of its chain, travels, points and table
    datum: str  # readings and tool length to which the values refer
    state: str  # time, temperatures and speed that they hold for
    sign: int  # +1 as this house understands the format; -1 where a control wants the opposite

    def lines(self) -> list[str]:
        """`matstd key: value`, one a field."""
        return [f"matstd {key}: {getattr(self, key)}" for key in self.__slots__]

    @classmethod
    def of(cls, text: str, path: str | Path) -> "Header":
        """Head of a table that was read; raises BadFile where it is none of ours, or was lost."""
        matches = (_LINE.match(line) for line in text.splitlines())
        found = {match[1]: match[2] for match in matches if match is not None}
        values = {key: found.get(f"matstd {key}") for key in cls.__slots__}
        missing = [key for key, value in values.items() if value is None]
        if missing:
            expected = f"a line 'matstd {missing[0]}: ...' as matstd compensate writes it"
            raise BadFile(path, "head", "none", expected)
        if values["sign"] not in ("1", "-1"):
            raise BadFile(path, "matstd sign", values["sign"], "1 or -1")
        return cls(**{**values, "sign": int(str(values["sign"]))})  # type: ignore[arg-type]

    def check(self, own: "Header", path: str | Path) -> None:
        """Refuse a table of another machine or datum; raises BadFile."""
        for key in ("machine", "datum"):
            found, expected = getattr(self, key), getattr(own, key)
            if found != expected:
                raise BadFile(path, f"matstd {key}", found, f"{expected}, as of this model")

    def refuse_active(self, own: "Header", path: str | Path) -> None:
        """Refuse to correct what an active table corrects already.

        Raises:
            BadFile: Always: of this machine, of another, or of another datum.
        """
        self.check(own, path)
        if self.model == own.model:
            found = "a table of this very model, which is active"
            raise BadFile(path, "matstd model", found, "it switched off: it would correct twice")
        found = f"an active table of model {self.model}"
        expected = f"it switched off, or a model learnt beside it (this one is {own.model})"
        raise BadFile(path, "matstd model", found, expected)


def header_of(chain: Chain, model: str, datum: Datum, state: State, sign: int = 1) -> Header:
    """Head of the tables of a machine."""
    return Header(
        model=model,
        machine=f"{chain.name}, {machine_hash(chain)}",
        datum=datum_text(chain, datum),
        state=state_text(state),
        sign=sign,
    )


def machine_hash(chain: Chain) -> str:
    """Hash of everything that a table depends on: chain, travels, directions, points, table."""
    words = [" ".join(chain.notation.split()), _digits(chain.table_origin)]
    for link in chain.links:
        words.append(f"{link.name} {_digits(link.range)} {_digits(link.direction)}")
        words.append(_digits(link.point))
    return hashed("\n".join(words).encode())


def hashed(data: bytes) -> str:
    """Twelve letters that identify a content."""
    return hashlib.sha256(data).hexdigest()[:12]


def datum_text(chain: Chain, datum: Datum) -> str:
    """`X0 Y0 Z-200 B0 C0 L160`: readings in mm and degrees, tool length."""
    words = []
    for name in chain.programmed_axes:
        reading = datum.zero[chain.axis_index(name)] / chain.link(name).unit
        words.append(f"{name}{reading + 0.0:.6g}")
    return " ".join([*words, f"L{datum.length:.6g}"])


def state_text(state: State) -> str:
    """`t=30min rpm=8000 T_spindle=25`."""
    words = [f"t={state.time / MINUTE:.6g}min"]
    if state.spindle_rpm is not None:
        words.append(f"rpm={state.spindle_rpm:.6g}")
    if state.force is not None and any(state.force):
        words += [f"F{axis}={value:.6g}N" for axis, value in zip("xyz", state.force, strict=True)]
    words += [f"T_{name}={value:.6g}" for name, value in state.temperature.items()]
    return " ".join([*words, *(f"V_{name}={value:.6g}" for name, value in state.value.items())])


def _digits(values: object) -> str:
    return " ".join(f"{float(v) + 0.0:.6f}" for v in values)  # type: ignore[attr-defined]
