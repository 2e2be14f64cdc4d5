"""Does the time left of a design fall, and is it right at half time?

    python benchmarks/progress_estimate.py PROJECT.toml ... [--record events.json]
    python benchmarks/progress_estimate.py --replay events.json ...

Runs every design (minutes each, on an idle machine) and records when its stages report; prints the
share of every stage, and the estimate at half time over what was left, with the shares of `matstd
design` and with those of the other recorded designs of machines of its kind.
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import matstd  # noqa: E402  (found through the path above)
from matstd.commands.standard.design import LINEAR_PLAN, PLAN  # noqa: E402
from matstd.progress import TimeLeft  # noqa: E402

Events = list[tuple[float, str, int, int]]
"""Seconds since the beginning, stage, done, total; the last one ends the run."""

PLANS = {True: PLAN, False: LINEAR_PLAN}  # the plan by whether the machine has a rotary axis
EVERY = 1.0  # seconds between two looks at the time left


def recorded(path: Path) -> tuple[bool, Events]:
    """Whether the machine of a project has a rotary axis, and the reports of its design."""
    events: Events = []
    begun = time.monotonic()  # the second core works too: processor time of this process is less

    def note(stage: str, done: int, total: int) -> None:
        events.append((time.monotonic() - begun, stage, done, total))

    with tempfile.TemporaryDirectory() as folder:
        project = matstd.Project.read(path)
        project.design(Path(folder) / "out", progress=note)
    events.append((time.monotonic() - begun, "end", 1, 1))
    return bool(project.brief.chain.rotary_axes), events


def shares(events: Events) -> dict[str, float]:
    """Share of every stage of the plan in the whole."""
    out = dict.fromkeys(PLAN.shares, 0.0)
    stage, since = events[0][1], 0.0
    for now, name, _, _ in events[1:]:
        if name in out or name == "end":
            out[stage] += now - since
            stage, since = name, now
    return {name: value / events[-1][0] for name, value in out.items()}


def replayed(events: Events, known: dict[str, float], usual: float) -> tuple[float, int]:
    """Estimate over truth at half time, and how often the time left rose."""
    left = TimeLeft(known, usual)
    end = events[-1][0]
    at_half, rises, last, k = np.nan, 0, np.inf, 0
    for now in np.arange(EVERY, end, EVERY):
        while k < len(events) - 1 and events[k][0] <= now:
            left.report(*events[k][1:], events[k][0])
            k += 1
        shown = left.left(now)
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
    runs: dict[str, tuple[bool, Events]] = {}
    for file in args.replay:
        for name, (turns, events) in json.loads(file.read_text(encoding="utf-8")).items():
            runs[name] = turns, [tuple(event) for event in events]
    for path in args.projects:
        runs[path.parent.name if path.stem == "project" else path.stem] = recorded(path)
        if args.record:
            args.record.write_text(json.dumps(runs), encoding="utf-8")
    for name, (turns, events) in runs.items():
        own = shares(events)
        others = [
            shares(es) for other, (kind, es) in runs.items() if other != name and kind is turns
        ]
        mean = {s: float(np.mean([o[s] for o in others])) for s in own} if others else own
        print(
            f"{name}: {events[-1][0]:.0f} s: " + ", ".join(f"{s} {v:.3f}" for s, v in own.items())
        )
        plan = PLANS[turns]
        for what, known in (("shares of the tool", plan.shares), ("of its kind", mean)):
            ratio, rises = replayed(events, dict(known), plan.usual)
            print(f"  {what}: at half time {ratio:.2f} of what was left, {rises} rises")


if __name__ == "__main__":
    main()
