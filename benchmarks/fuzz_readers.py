"""Do damaged files ever end in a traceback or in wrong numbers?

    python benchmarks/fuzz_readers.py [-n 20000] [--seed 1] [--only run]

Damages a valid file of every reader in N ways and reads it. A reader refuses in one line, or what
it gives is what stands in the file, or it says what it mended. Prints how often what happened, and
every fault with the input that makes it again; ends with 1 if there was any.
"""

import argparse
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / part) for part in (".", "tests/fixtures", "tests/golden")]

from border_cases import border_readers  # noqa: E402  (found through the path above)
from foreign_cases import foreign_readers  # noqa: E402
from reader_cases import Reader, damage, golden, readers  # noqa: E402

from matstd.twin.errors import DesignError  # noqa: E402

SLOW = 5.0  # longest processor time that any small file may take to be read or refused, s
LONGEST = 900  # longest line of a refusal, characters: it is read on a screen
KEPT = 12  # faults that are shown in full


def outcome(reader: Reader, data: bytes) -> tuple[str, str]:
    """What happens to a damaged file, and why where it should not."""
    reader.path.write_bytes(data)
    begin = time.process_time()
    try:
        result = reader.read(reader.path)
    except DesignError as error:
        line = str(error).replace(str(reader.path), "FILE")
        if "\n" in line or len(line) > LONGEST:
            return "refused at length", f"{len(line)} characters: {line[:200]!r}"
        found = "refused"
    except BaseException as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(last.filename).name}:{last.lineno}"
        return "traceback", f"{type(error).__name__} at {place}: {str(error)[:120]}"
    else:
        text = data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
        try:
            is_said = reader.said is None or reader.said(text, result)
        except Exception as error:
            return "not what it says", f"{type(error).__name__} in the naive reading: {error}"
        if not is_said:
            return "not what it says", ""
        found = "read, with remarks" if getattr(result, "remarks", ()) else "read"
    spent = time.process_time() - begin
    return ("slow", f"{spent:.1f} s") if spent > SLOW else (found, "")


def main() -> int:
    """Damage, read, count."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-n", type=int, default=20_000, help="inputs over all readers")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="one reader")
    args = parser.parse_args()
    warnings.simplefilter("error")
    with tempfile.TemporaryDirectory() as folder:
        place, made = Path(folder), golden
        every = [*readers(place), *foreign_readers(place, made), *border_readers(place, made)]
        chosen = [r for r in every if args.only in ("", r.name)]
        faults: Counter[tuple[str, str, str]] = Counter()
        for reader in chosen:
            valid = reader.path.read_text(encoding="utf-8")
            assert outcome(reader, valid.encode())[0].startswith("read"), reader.name
            counts: Counter[str] = Counter()
            begin = time.perf_counter()
            for k in range(args.n // len(chosen)):
                rng = np.random.default_rng([args.seed, len(reader.name), k])
                what, why = outcome(reader, damage(rng, valid))
                counts[what] += 1
                if why:
                    faults[reader.name, what, why] += 1
                    if faults[reader.name, what, why] == 1 and len(faults) <= KEPT:
                        print(f"  {reader.name} input {k}: {what}: {why}", flush=True)
            stated = ", ".join(f"{n} {what}" for what, n in sorted(counts.items()))
            print(f"{reader.name:9} {stated} ({time.perf_counter() - begin:.0f} s)", flush=True)
    print(f"{sum(faults.values())} faults of {len(faults)} sorts")
    for (name, what, why), count in faults.most_common():
        print(f"  {count:5} {name}: {what}: {why}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
