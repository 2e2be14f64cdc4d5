"""Size, speed and figures of the live page, in headless Chromium.

    python benchmarks/live_page.py [--touches 780 20000] [--sets 30]

Runs come from the independent exact simulator with one hidden effect. Measured are: what the live
view adds to the page and to the command, the first paint, the time from a switch until every
picture is drawn and handed to the browser (median and worst of all switches, twice), the same
while a gain is pulled, and how far fitted and held-out error of random sets of switches are from
fits to the touches in Python, with the time of such a fit for comparison. No request may leave the
page.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from harness import parser_of  # puts simulator and browser on the path

HIDDEN = "thermal-lag(EZZ)"
LONG = 4000  # touches from which a run is compared only: a diagnosis of it takes minutes

PAINTED = """const done = arguments[arguments.length - 1], begun = performance.now();
{};
requestAnimationFrame(() => setTimeout(() => done(performance.now() - begun)));"""
FIRST = """return performance.getEntriesByName("first-contentful-paint")[0]?.startTime"""
ONLY = """livePage.board.reset();
for (const s of livePage.board.switches) s.isOn = {}.includes(s.name);
const {{ columns }} = livePage.board.columns(livePage.board.on);
const found = livePage.board.solver.errors(columns);
return [found.fitted, found.heldOut];"""


def simulated(folder: Path, touches: int):
    """A run of about so many touches."""
    from simulator_case import read_back, simulate_case

    poses = max(round(touches / 78), 10)
    case = simulate_case(
        np.random.default_rng(5), "hsm600u", [HIDDEN], with_alike=False, poses=poses
    )
    return read_back(case[0], case[1])


def made(touches: int, folder: Path):
    """The page of a run and its board, with the time and memory that the view takes."""
    from matstd.diagnosis.answer import compare, diagnose
    from matstd.diagnosis.reduced import compared_board, diagnosed_board
    from matstd.report.layout import Page, write_page
    from matstd.report.run_view import Findings, run_view

    run = simulated(folder, touches)
    is_long = len(run) > LONG
    result = compare(run) if is_long else diagnose(run)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.process_time()
    board = compared_board(result) if is_long else diagnosed_board(result)
    view = run_view(board, Findings("run.csv"))
    taken = time.process_time() - start
    more = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    path = folder / "report.html"
    write_page(path, Page(heading="h", lead="l", key=(), sections=(), live=view))
    print(
        f"{len(run)} touches, {len(board.switches)} effects, {len(board.estimate)} columns: "
        f"{path.stat().st_size / 1e6:.2f} MB; making it {taken:.2f} s of processor, {more:.0f} MB"
    )
    return path, board


def refitted(board, names):
    """The model with a set of effects fitted to the touches."""
    from matstd.diagnosis.fit import Prior, fit_run
    from matstd.twin.model import Model

    fit = board.fit
    base = [e for e in fit.model.effects if e.name not in board.found]
    count = sum(len(e.parameters) for e in base)
    prior = Prior(fit.prior.mean[:count], fit.prior.root[:count, :count], np.ones(count))
    chosen = [s for s in board.switches if s.effect.name in names]
    for one in chosen:
        prior = prior.joined(Prior(np.zeros(len(one.sd)), np.diag(one.sd)))
    model = Model(fit.model.chain, (*base, *(s.effect for s in chosen)))
    return fit_run(fit.run, model, prior, gross=fit.gross, memory=fit.memory)


def processor(driver) -> float:
    """Time that the page's own thread has worked, s: other work on the machine does not count."""
    metrics = driver.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
    return next(m["value"] for m in metrics if m["name"] == "TaskDuration")


def speeds(driver, path: Path, count: int) -> None:
    """First paint, and from a switch or a pull to the painted picture."""
    from browser import faults, opened, requests

    start = time.perf_counter()
    opened(driver, path)
    loaded = 1e3 * (time.perf_counter() - start)
    click = "document.querySelectorAll('#effect-list input[type=checkbox]')[{}].click()"
    solve, switches, pulls, own = [], [], [], []
    driver.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
    for k in [*range(count), *range(count)]:
        before = processor(driver)
        switches.append(driver.execute_async_script(PAINTED.format(click.format(k))))
        own.append(1e3 * (processor(driver) - before))
        solve.append(float(driver.execute_script("return live.dataset.milliseconds")))
        time.sleep(0.3)  # the errors beside the switches come after the paint
    driver.execute_script(
        "const b = livePage.board; b.reset(); if (!b.on.length) b.toggle(b.switches[0], true);"
        "livePage.changed()"
    )
    pull = "livePage.board.pull(livePage.board.on[0], {:.2f}); livePage.changed()"
    for gain in np.linspace(0.0, 2.0, 15):
        pulls.append(driver.execute_async_script(PAINTED.format(pull.format(gain))))
    print(
        f"  first paint {driver.execute_script(FIRST):.0f} ms, loaded {loaded:.0f} ms; switch: "
        f"script {np.median(solve):.0f} (worst {max(solve):.0f}) ms, drawn "
        f"{np.median(switches):.0f} (worst {max(switches):.0f}) ms, of processor "
        f"{np.median(own):.0f} (worst {max(own):.0f}) ms; gain pulled "
        f"{np.median(pulls):.0f} (worst {max(pulls):.0f}) ms"
    )
    print(f"  requests that left the page: {len(requests(driver))}; faults: {faults(driver)}")


def agreement(driver, board, sets: int) -> None:
    """Random sets of switches against fits to the touches."""
    from matstd.twin.numbers import significant
    from matstd.twin.units import UM

    rng, names = np.random.default_rng(0), [s.effect.name for s in board.switches]
    worst, same, printed, taken = 0.0, 0, 0, 0.0
    for k in range(sets):
        on = rng.choice(names, min(k % 14, len(names)), replace=False).tolist()
        start = time.process_time()
        fit = refitted(board, on)
        taken += time.process_time() - start
        known = np.array([fit.rms, fit.test_rms]) / UM
        shown = np.array(driver.execute_script(ONLY.format(json.dumps(on))))
        worst = max(worst, float(np.abs(shown / known - 1.0).max()))
        printed += all(f"{a:.3f}" == f"{b:.3f}" for a, b in zip(shown, known, strict=True))
        same += all(significant(a) == significant(b) for a, b in zip(shown, known, strict=True))
    print(
        f"  {sets} sets against refits: worst {worst:.1e} relative, digits that the page prints "
        f"equal in {printed}, all six of the file in {same}; a refit in Python takes "
        f"{1e3 * taken / sets:.0f} ms of processor"
    )


def one(touches: int, sets: int) -> None:
    """Everything of one size."""
    from browser import started

    with tempfile.TemporaryDirectory() as folder:
        path, board = made(touches, Path(folder))
        driver = started()
        try:
            speeds(driver, path, len(board.switches))
            agreement(driver, board, sets)
        finally:
            driver.quit()


def main() -> None:
    """Each size in a process of its own."""
    parser = parser_of(__doc__)
    parser.add_argument("--touches", type=int, nargs="+", default=[780, 20000])
    parser.add_argument("--sets", type=int, default=30)
    parser.add_argument("--alone", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.alone:
        one(given.touches[0], given.sets)
        return
    for touches in given.touches:
        own = ["--alone", "--touches", str(touches), "--sets", str(given.sets)]
        subprocess.run([sys.executable, __file__, *own], check=True)


if __name__ == "__main__":
    main()
