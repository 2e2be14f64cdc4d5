"""The page of a machine: what it costs to make, its size, and how fast it answers in Chromium.

    python benchmarks/machine_page.py

Needs chromium, chromium-driver and selenium. One pose with all errors in the page is compared with
the same pose by itself in Python, in the same run.
"""

import tempfile
import time
from pathlib import Path

import numpy as np
from harness import parser_of  # puts the browser on the path

import matstd
from matstd.compensation.field import MachineErrors, actual_tip
from matstd.sensitivity.population import Population, drawn_errors
from matstd.twin.files import errors_toml

POSES = 500
SCRIPT = """
const p = machinePage, poses = arguments[0], begin = performance.now();
for (const q of poses) { p.state.q.set(q); p.show(); }
const shown = (performance.now() - begin) / poses.length, then = performance.now();
for (const q of poses) p.toolPoint(q, 150, p.errorsAt({ q, sides: p.state.sides, time: 0 }));
const paint = performance.getEntriesByName("first-contentful-paint")[0];
return [shown, (performance.now() - then) / poses.length, paint ? paint.startTime : NaN];
"""


def main() -> None:
    parser_of(__doc__).parse_args()
    from browser import opened, started

    machine = matstd.machine_file("hsm600u")
    chain = matstd.read_machine(machine)
    drawn = drawn_errors(Population(chain), np.random.default_rng(1))
    errors = MachineErrors.of_errors(chain, drawn)
    low, high = chain.travels.T
    q = np.random.default_rng(2).uniform(low, high, (POSES, len(low)))
    with tempfile.TemporaryDirectory() as name:
        known, page = Path(name, "errors.toml"), Path(name, "machine.html")
        known.write_text(errors_toml(drawn), encoding="utf-8")
        begin = time.process_time()
        matstd.show(machine, known).save(page)
        made = time.process_time() - begin
        driver = started()
        opened(driver, page)
        time.sleep(2.0)
        shown, alone, paint = driver.execute_script(SCRIPT, q.tolist())
        driver.quit()
        size = page.stat().st_size / 1e6
    begin = time.perf_counter()
    for row in q[:100]:
        actual_tip(errors, errors.touches(row[None], 150.0))
    python = 10.0 * (time.perf_counter() - begin)
    print(f"{len(errors.groups)} errors: made in {made:.2f} s of processor, {size:.2f} MB")
    print(f"first paint {paint:.0f} ms; a change of an axis {shown:.2f} ms of script")
    print(f"tool point with all errors {alone:.3f} ms, in Python {python:.2f} ms a pose")


if __name__ == "__main__":
    main()
