"""Compensation: the machine that Chen published in 1995 mills a plate, without and with it.

Its errors go back to it in two ways: as a compensated part program, and as tables of controls.
"""

import tempfile
from importlib.resources import files
from pathlib import Path

from matstd.compensation.field import MachineErrors, State, datum_of, sample_workspace
from matstd.compensation.part_programs import Frame, read_part_program
from matstd.compensation.programs import compensated
from matstd.compensation.tables import FORMATS, header_of, verify_tables, write_tables
from matstd.twin.files import read_errors, read_machine

MACHINES = Path(str(files("matstd").joinpath("machines")))
PLATE = "G0 X0 Y0 Z5\nG1 Z0 F800\nG1 X300\nG1 Y200\nG1 X0\nG1 Y0\nG0 Z5\n"


def known_errors():
    chain = read_machine(MACHINES / "hmc1995.toml")
    return MachineErrors.of_errors(chain, read_errors(MACHINES / "hmc1995-errors.toml", chain))


def main():
    errors = known_errors()
    datum = datum_of(errors.chain, {"X": -150.0, "Y": -100.0, "Z": -250.0}, 150.0)
    head, poses = (
        header_of(errors.chain, "chen1995", datum, State()),
        sample_workspace(errors.chain, {}),
    )
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        plate = Path(folder) / "plate.ngc"
        plate.write_text(PLATE)
        program = read_part_program(plate, Frame(errors.chain, datum))
        found["plate"] = compensated(program, errors, head)
        for name in ("iso230", "sinumerik"):
            place = Path(folder) / name
            write_tables(FORMATS[name], place, errors, datum, head, poses)
            found[name] = verify_tables(FORMATS[name], place, errors, datum, head, poses).result
    return found


if __name__ == "__main__":
    from matstd.report.compensation import draw_program, program_lines, result_sentence
    from matstd.report.style import save

    results = main()
    plate = results.pop("plate")
    print(*program_lines("plate", plate), sep="\n- ")
    print(*(f"{name}: {result_sentence(result)}" for name, result in results.items()), sep="\n")
    save(draw_program(plate), Path(__file__).parent / "pictures" / "ex11.png")
