"""Laws of a thermal drift and their errors, in sentences."""

from collections.abc import Iterator

from matstd.diagnosis.drift import DriftRecord, Judged, JudgedLaws, ProbedPrediction
from matstd.report.numbers import digits, span
from matstd.twin.frames import IntArray
from matstd.twin.units import MINUTE

_TITLES = {
    "hold": "last value held",
    "constant": "constant",
    "static-ridge": "ridge on all drives at once",
    "speed-lags": "ridge, speed with first-order lags",
    "lags": "ridge, all drives with first-order lags",
}


def law_title(name: str) -> str:
    """A law in words."""
    return _TITLES.get(name, name)


def units_word(record: DriftRecord) -> str:
    """Unit of the components together."""
    return " and ".join("µm" if u == "mm" else "µrad" for u in dict.fromkeys(record.units))


def drift_lines(found: JudgedLaws) -> Iterator[tuple[str, bool]]:
    """The table of laws and the choice, line by line, and whether a line is the chosen one."""
    record, judged, best = found.record, found.judged, found.best
    has_noise = any(j.noisy is not None for j in judged)
    head = f"{'rms over ' + str(len(record.components)) + ' components, ' + units_word(record):<42}"
    head += f"{'one step':>10}{'left out':>10}{'held out':>10}"
    yield head + (f"{'with noise':>12}" if has_noise else ""), False
    step = digits(record.together(found.hold))
    yield f"{law_title('hold'):<42}{step:>10}{'–':>10}{'–':>10}", False
    for j in judged:
        cells = [digits(record.together(v)) for v in (j.one_step, j.left_out, j.free_run)]
        line = f"{law_title(j.name):<42}" + "".join(f"{c:>10}" for c in cells)
        if j.noisy is not None:
            line += f"{digits(record.together(j.noisy)):>12}"
        yield line, j is best
    yield f"chosen by the blocks left out: {law_title(best.name)}; {law_words(best, record)}", True


def law_words(judged: Judged, record: DriftRecord) -> str:
    """Uncertainty of a law, and its terms."""
    u = judged.u(record)
    return f"u {digits(record.together(u), 2)} {units_word(record)}"


def clock_line(lead: float) -> str:
    """Displacements that precede their cause."""
    return (
        f"the displacements change {span(lead, 2)} before the speed does: synchronise the clocks "
        "of both logs"
    )


def kept_line(result: ProbedPrediction, record: DriftRecord, rows: IntArray, every: float) -> str:
    """Error with probings `every` so often (s), with a law and without."""
    left, plain = (
        record.together((v - record.displacement)[rows])
        for v in (result.predicted, result.offset_only)
    )
    every_words = f"{every / MINUTE:.0f} min" if every < 120 * MINUTE else span(every)
    return (
        f"probed every {every_words}: {digits(left)} {units_word(record)} held out "
        f"({digits(plain)} with the probed value held, without a law)"
    )
