"""Ten lines for a machine of your own: what its model lacks, report, tables for its control.

The run is that of the machine of 1995; with another machine only the names of files change.
"""

import tempfile
from pathlib import Path

import matstd

RUN = Path(__file__).parent / "machine_1995" / "run.csv"


def main(folder):
    found = matstd.diagnose(RUN, only=["thermal-lag"], auto=True)
    found.save(folder / "diagnosis")  # model.toml, diagnosis.json, report.html with its pictures
    warm = matstd.State(time=180.0 * matstd.MINUTE)  # since the machine was switched on
    machine = found.compensate(tool_length=150.0, state=warm)
    tables = machine.tables(folder / "tables", ["iso230"])  # written, read back and played
    return {"diagnosis": found, "machine": machine, "tables": tables.done[0].result}


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        result = main(Path(place))
    print(result["diagnosis"])
