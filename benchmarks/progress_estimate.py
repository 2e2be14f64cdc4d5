"""Does the time left of a design fall, and is it right at half time?

    python benchmarks/progress_estimate.py PROJECT.toml ... [--record events.json]
    python benchmarks/progress_estimate.py --replay events.json ...

Runs every design (minutes each) and records when its stages report: by the clock, and as two idle
cores would have run it. There a step takes the longest processor time of this process and of those
which it has begun, and half of their sum at least. Prints the seconds of every stage, and the
estimate at half time over what was left.
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import psutil

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import matstd  # noqa: E402  (found through the path above)
from matstd.commands.standard.design import LINEAR_PLAN, PLAN  # noqa: E402
from matstd.progress import Plan, Watch  # noqa: E402


class Event(NamedTuple):
    """A report; the last one ends the run."""

    clock: float  # since the beginning, s
    idle: float  # the same on two idle cores, s
    stage: str
    done: int
    total: int


EVERY = 1.0  # seconds between two looks at the time left


def recorded(path: Path) -> tuple[bool, list[Event]]:
    """Whether the machine of a project has a rotary axis, and the reports of its design."""
    events, used, begun = list[Event](), dict[int, float](), time.monotonic()

    def note(stage: str, done: int, total: int) -> None:
        here, before = psutil.Process(), used.copy()
        for process in (here, *here.children(recursive=True)):
            used[process.pid] = sum(process.cpu_times()[:2])
        steps = [now - before.get(pid, 0.0) for pid, now in used.items()]
        step = max(*steps, 0.5 * sum(steps)) if events else 0.0
        idle = step + (events[-1].idle if events else 0.0)
        clock = time.monotonic() - begun
        events.append(Event(clock=clock, idle=idle, stage=stage, done=done, total=total))

    with tempfile.TemporaryDirectory() as folder:
        project = matstd.Project.read(path)
        project.design(Path(folder) / "out", progress=note)
    note("end", 1, 1)
    return bool(project.brief.chain.rotary_axes), events


def seconds(events: list[Event]) -> dict[str, float]:
    """Of every stage of the plan, on two idle cores."""
    out = dict.fromkeys(PLAN, 0.0)
    stage, since = events[0].stage, 0.0
    for event in events[1:]:
        if event.stage in out or event.stage == "end":
            out[stage] += event.idle - since
            stage, since = event.stage, event.idle
    return out


def replayed(events: list[Event], plan: Plan, is_idle: bool) -> tuple[float, int]:
    """Estimate over truth at half time, and how often the time left rose."""
    watch, times = Watch.of(plan, 0.0), [one.idle if is_idle else one.clock for one in events]
    end = times[-1]
    at_half, rises, last, k = np.nan, 0, np.inf, 0
    for now in np.arange(EVERY, end, EVERY):
        while k < len(events) - 1 and times[k] <= now:
            watch.report(*events[k][2:], times[k])
            k += 1
        shown = watch.left.left(now)
        if shown is not None:
            rises += shown > last + 1e-9
            last = shown
            if now <= 0.5 * end:
                at_half = shown / (end - now)
    return float(at_half), rises


def main() -> None:
    """Record or replay, and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("projects", nargs="*", type=Path)
    parser.add_argument("--record", type=Path)
    parser.add_argument("--replay", nargs="*", type=Path, default=[])
    args = parser.parse_args()
    runs: dict[str, tuple[bool, list[Event]]] = {}
    for file in args.replay:
        for name, (turns, events) in json.loads(file.read_text(encoding="utf-8")).items():
            runs[name] = turns, [Event(*event) for event in events]
    for path in args.projects:
        runs[path.parent.name if path.stem == "project" else path.stem] = recorded(path)
        if args.record:
            args.record.write_text(json.dumps(runs), encoding="utf-8")
    for name, (turns, events) in runs.items():
        print(f"{name}: " + ", ".join(f"{s} {v:.1f} s" for s, v in seconds(events).items()))
        for is_idle, what in ((False, "by the clock"), (True, "on two idle cores")):
            ratio, rises = replayed(events, PLAN if turns else LINEAR_PLAN, is_idle)
            end = events[-1].idle if is_idle else events[-1].clock
            print(f"  {what} {end:.0f} s: at half time {ratio:.2f} of what was left, {rises} rises")


if __name__ == "__main__":
    main()
