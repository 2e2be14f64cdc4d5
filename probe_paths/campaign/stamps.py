"""Whether a program, or the log of one, was written for the standard that is given.

Looked at before anything else: what follows from a wrong standard (a touch without contact, a ball
in a post) would hide the cause.
"""

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from matstd.artefact.body import Standard
from matstd.probe_paths.control import ReadProgram, read_program, stated_heading
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import Heading, Probe, calibration_hash, stated_serial
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.machine import Chain


def read_program_of(
    standard: Standard,
    path: str | Path,
    chain: Chain,
    probe: Probe | None = None,
    dialect: Dialect | None = None,
) -> ReadProgram:
    """A program that was written for a standard.

    Raises:
        BadFile: As of `read_program`.
        DesignError: What the program was written for. Of a program for another machine this says
            more than the first block that the machine cannot run.
    """
    try:
        program = read_program(path, chain, probe, dialect)
    except BadFile:
        with suppress(BadFile):  # a head that cannot be read either
            _check_name(path, stated_heading(path, dialect), standard)
        raise
    check_program_stamp(program, standard)
    return program


def check_program_stamp(program: ReadProgram, standard: Standard, believed: bool = True) -> None:
    """Refuse a program of another standard; raises DesignError.

    Args:
        believed: Whether the numbers of the standard are those that programs are made from; the
            piece as it really is has others.
    """
    path, heading = program.path, program.heading
    _check_name(path, heading, standard)
    names = list(heading.touched(standard).features)
    for number, name in program.features.items():
        if not 0 < number <= len(names) or names[number - 1] != name:
            raise DesignError(
                f"{path}: feature {number} is {name} in the program; standard "
                f"'{standard.name}' has {', '.join(f'{i + 1} {n}' for i, n in enumerate(names))}"
            )
    if believed:
        _check_numbers(path, heading, heading.touched(standard))


def check_log_stamp(path: str | Path, heading: Heading, standard: Standard) -> None:
    """Refuse the log of a program of another standard; arguments and errors as of a program."""
    path = f"{path}: its program"
    _check_name(path, heading, standard)
    balls = standard.spheres[:-1] if heading.ball else standard.spheres
    _check_numbers(path, heading, replace(standard, spheres=balls))


def _check_name(path: str | Path, heading: Heading, standard: Standard) -> None:
    """Refuse another standard, by name and serial number."""
    serial = stated_serial(standard.serial)
    stated = heading.serial
    if heading.standard != standard.name or (stated and stated != serial):
        ours = f"{standard.name} {serial}".strip() if stated else standard.name
        raise DesignError(f"{path} was written for {heading.stamp}; you gave {ours}")


def _check_numbers(path: str | Path, heading: Heading, standard: Standard) -> None:
    """Refuse another design of the same name; a calibrated standard has other numbers by right."""
    stated = heading.calibration
    if stated and standard.known is None and stated != (ours := calibration_hash(standard)):
        raise DesignError(
            f"{path} was written for another design of {standard.name} ({stated}); you gave "
            f"{standard.name} ({ours})"
        )
