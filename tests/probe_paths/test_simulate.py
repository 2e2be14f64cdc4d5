"""`matstd simulate`: the thin command round it all."""

import json
import re
import shutil
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import numpy as np
import pytest

from matstd.artefact.body import write_standard
from matstd.artefact.tool import Probe
from matstd.cli import main
from matstd.diagnosis.fit import fit_run
from matstd.probe_paths.campaign.contact_solver import FIRST_MORNING
from matstd.probe_paths.emit import make_programs
from matstd.probe_paths.plan import PlanOptions, plan_touches
from matstd.twin.files import read_run
from matstd.twin.model import Model
from matstd.twin.record import Body, joined
from matstd.twin.units import NM, UM

MACHINE = Path(__file__).parents[2] / "examples" / "hsm600u-machine.toml"
"""The golden programs' machine has the same travels and pivots."""


ALL = ("MS_A_1", "MS_A_2", "MS_A_3")
NARROW = ["--only", "thermal-lag", "backlash", "--no-report", "--no-learn"]
"""A planted warming is looked for among its rivals, not in the whole library."""


def laid_out(place, programs, small):
    (place / "programs").mkdir()
    programs.write(place / "programs")
    write_standard(place / "standard.toml", small)
    shutil.copy(MACHINE, place / "machine.toml")
    return place


@pytest.fixture
def folder(tmp_path, programs, small):
    """Programs, standard and machine as a design run leaves them."""
    return laid_out(tmp_path, programs, small)


@pytest.fixture(scope="module")
def simulated_once(tmp_path_factory, programs, small):
    place = laid_out(tmp_path_factory.mktemp("simulated"), programs, small)
    assert command(place, "--logs", str(place / "logs"), programs=ALL) == 0
    return place


@pytest.fixture
def logged(simulated_once, tmp_path):
    """The same with the logs of a simulation."""
    return shutil.copytree(simulated_once, tmp_path / "logged")


def command(folder, *more, programs=ALL[:1]):
    files = [str(folder / "programs" / f"{name}.H") for name in programs]
    places = [
        "--standard",
        str(folder / "standard.toml"),
        "--machine",
        str(folder / "machine.toml"),
    ]
    return main(["simulate", *files, *places, "-o", str(folder / "out" / "run.csv"), *more])


def test_a_run_file_of_all_programs(folder, plan, capsys):
    options = ("--noise-um", "0", "--logs", str(folder / "logs"))
    assert command(folder, *options, programs=ALL) == 0
    assert f"{len(plan)} touches" in capsys.readouterr().out
    run = read_run(folder / "out" / "run.csv")
    assert len(run) == len(plan)
    assert np.abs(run.deviation).max() < NM
    assert run.touches.feature.tolist() == plan.feature.tolist()
    assert {p.name for p in (folder / "logs").iterdir()} == {f"MS_A_{i}.TXT" for i in (1, 2, 3)}
    assert not list((folder / "out").glob(".*"))


def test_errors_of_a_file_and_drawn_ones(folder):
    (folder / "errors.toml").write_text(
        'format = "errors/1"\n[EXX]\nshape = "linear"\namplitude = 100.0\n', encoding="utf-8"
    )
    assert command(folder, "--errors", str(folder / "errors.toml"), "--noise-um", "0") == 0
    one = read_run(folder / "out" / "run.csv")
    assert 1.0 * UM < np.sqrt(np.mean(one.deviation**2)) < 100.0 * UM
    texts = []
    for seed in ("3", "3", "4"):
        assert command(folder, "--random-errors", "--seed", seed, "--force") == 0
        texts.append((folder / "out" / "run.csv").read_text(encoding="utf-8"))
    assert texts[0] == texts[1]
    assert texts[0] != texts[2]


def test_an_existing_run_file_is_not_overwritten(folder, capsys):
    (folder / "out").mkdir()
    (folder / "out" / "run.csv").write_text("a year of measurements", encoding="utf-8")
    assert command(folder) == 2
    message = capsys.readouterr().err
    assert "already exists" in message
    assert message.count("\n") == 1
    kept = (folder / "out" / "run.csv").read_text(encoding="utf-8")
    assert kept == "a year of measurements"
    assert command(folder, "--force") == 0


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        (("--noise-um", "-1"), "expected noise from 0"),
        (("--noise-um", "nan"), "expected noise from 0"),
        (("--seed", "-1"), "a seed from 0 up"),
        (("--probe-length", "150"), "a probe of length 160 mm, expected 150 mm"),
        (("--probe-radius", "200"), "expected 0 < radius < length"),
        (("--errors", "none.toml"), "none.toml"),
        (("--add", "backlash(X)=3"), "a number with its unit, such as 5um"),
        (("--add", "thermal-lag(EZZ,ram)=3um/K,tau=9min"), "no temperature sensor 'ram'"),
        (("--sensors", "none.csv"), "none.csv"),
        (("--setup-error", "X=3"), "--setup-error X=3: '3'"),
        (("--probe-error", "size=3um"), "no parameter 'size'"),
    ],
)
def test_bad_input_gets_one_line_and_no_file(folder, capsys, more, expected):
    assert command(folder, *more) == 2
    message = capsys.readouterr().err
    assert expected in message
    assert message.count("\n") == 1
    assert not (folder / "out" / "run.csv").exists()


def test_a_program_that_stops_leaves_no_run_file(folder, capsys):
    """The standard stands 9 mm too low, and the probe gives up 3 mm beyond where it should be."""
    assert command(folder, "--setup-error", "Z=-9mm") == 2
    message = capsys.readouterr().err
    assert "touch 1 on" in message
    assert "has no contact: the ball meets nothing" in message
    assert message.count("\n") == 1
    assert not (folder / "out" / "run.csv").exists()


def test_a_touch_that_looks_the_other_way_is_refused_before_it_runs(folder, capsys):
    path = folder / "programs" / "MS_A_1.H"
    data = path.read_bytes()
    vector = data.split(b"TCH PROBE 4.2 ")[2].split(b"\r\n")[0]
    path.write_bytes(data.replace(vector, vector.translate(bytes.maketrans(b"+-", b"-+"))))
    assert command(folder) == 2
    message = capsys.readouterr().err
    assert "a ball that meets nothing within the travel, expected touch 2 on" in message
    assert message.count("\n") == 1
    assert not (folder / "out" / "run.csv").exists()


def test_a_missing_mask_is_named(folder, capsys):
    (folder / "programs" / "MSPOINT.A").unlink()
    assert command(folder) == 2
    assert (
        "found mask MSPOINT.A, expected a mask file beside the program" in capsys.readouterr().err
    )


def test_another_standard_is_refused(folder, small, capsys):
    (folder / "standard.toml").unlink()
    write_standard(folder / "standard.toml", replace(small, patches=small.patches[::-1]))
    assert command(folder) == 2
    assert "feature 1 is FF1 in the program" in capsys.readouterr().err
    (folder / "standard.toml").unlink()
    write_standard(folder / "standard.toml", replace(small, name="L-2"))
    assert command(folder) == 2
    assert "was written for SMALL-1 (" in capsys.readouterr().err
    # so is a program for another machine, whose blocks this one cannot run
    program = folder / "programs" / "MS_A_1.H"
    program.write_text(program.read_text().replace("L Z-1.0000", "L A-1.0000", 1))
    assert command(folder) == 2
    assert "was written for SMALL-1 (" in capsys.readouterr().err


def evaluated(folder, *more, logs="logs"):
    files = sorted(str(p) for p in (folder / logs).iterdir())
    places = [
        "--standard",
        str(folder / "standard.toml"),
        "--machine",
        str(folder / "machine.toml"),
    ]
    return main(["evaluate", *files, *places, "-o", str(folder / "read" / "run.csv"), *more])


def test_logs_of_a_control_become_the_run_that_was_simulated(folder, capsys):
    """`evaluate` sees logs, standard and nominal machine; `simulate` said the same of them."""
    options = ("--random-errors", "--logs", str(folder / "logs"))
    assert command(folder, *options, programs=ALL) == 0
    assert evaluated(folder) == 0
    assert "touches at 5 table poses" in capsys.readouterr().out
    made, read = (read_run(folder / name / "run.csv") for name in ("out", "read"))
    assert np.abs(made.deviation - read.deviation).max() < NM
    assert np.array_equal(made.touches.pose, read.touches.pose)
    assert evaluated(folder) == 2
    assert "already exists" in capsys.readouterr().err


def test_a_run_knows_the_line_of_its_program(logged):
    """At it stands the cycle, above it the comment with the number and feature of the touch."""
    assert evaluated(logged) == 0
    made, read = (read_run(logged / name / "run.csv") for name in ("out", "read"))
    for name in ("program", "touch", "program_line"):
        assert np.array_equal(getattr(made, name), getattr(read, name)), name
    for row in range(0, len(made), 7):
        file = logged / "programs" / f"{made.program[row]}.H"
        lines = file.read_text(encoding="utf-8").splitlines()
        at = int(made.program_line[row]) - 1
        assert "TCH PROBE 4" in lines[at]
        comment = next(line for line in lines[at::-1] if ";TOUCH" in line)
        assert f";TOUCH {made.touch[row]} ON {made.touches.feature[row]}" in comment
    both = joined({"first": made, "second": replace(read, deviation=read.deviation + UM)})
    assert both.program_line.tolist() == [*made.program_line, *read.program_line]
    assert both[::2].touch.tolist() == both.touch[::2].tolist()


def test_a_log_that_stopped_is_used_and_reported(logged, capsys):
    log = sorted((logged / "logs").iterdir())[-1]
    lines = log.read_text(encoding="ascii").splitlines()
    log.write_text("\n".join(lines[:-6]) + "\n", encoding="ascii")
    assert evaluated(logged) == 0
    assert "stopped after" in capsys.readouterr().out


def _rows(lines, begins):
    return [i for i, line in enumerate(lines) if re.match(begins, line)]


def _dead_clock(lines):
    times = [i for i in _rows(lines, r"T ") if i > 12]
    return [lines[times[0]] if i in times else line for i, line in enumerate(lines)]


def _rewritten(begins, number, change, count=0):
    """Damage of the lines that begin so: numbers of a pattern, each changed."""

    def damage(lines):
        return [
            re.sub(number, lambda m: change(m[1]), line, count=count)
            if line.startswith(begins)
            else line
            for line in lines
        ]

    return damage


def _other_number(word):
    return _rewritten("TOOL", rf"{word} *([0-9.]+)", lambda v: f"{word} {float(v) + 1:.1f}")


def _another_pose(lines):
    place = _rows(lines, r"P ")[2]
    return [
        re.sub(r"S *([0-9.]+)", lambda m: f"S {float(m[1]) + 1:.1f}", line) if i == place else line
        for i, line in enumerate(lines)
    ]


@pytest.mark.parametrize(
    ("damage", "expected"),
    [
        (_dead_clock, "the same time at all"),
        (
            _rewritten("DATE", r"(\d{4})(?=-)", lambda y: f"{int(y) - 1}", 1),
            "logs of one campaign, within 30 days",
        ),
        (_rewritten("U", r"(?<=U[A-C])( *-?[0-9.]+)", lambda v: f" {-float(v):.1f}"), "side of "),
        (
            _rewritten("X", r"(-?\d+\.\d+)", lambda v: f"{float(v):.1f}"),
            "in steps of 0.01 mm or more",
        ),
        (_other_number("TOOL"), "TOOL: found 31, expected 30, as MS_A"),
        (_other_number("PRESET"), "PRESET: found 2, expected 1, as MS_A"),
        (_another_pose, "pose "),
    ],
)
def test_a_log_that_says_something_else_than_its_program_is_refused(
    logged, capsys, damage, expected
):
    """Text that was damaged on its way; before these all came out as measurements."""
    log = sorted((logged / "logs").iterdir())[0]
    lines = log.read_text(encoding="ascii").splitlines()
    log.write_text("\n".join(damage(lines)) + "\n", encoding="ascii")
    assert damage(lines) != lines
    assert evaluated(logged) == 2
    message = capsys.readouterr().err
    assert expected in message
    assert log.name in message
    assert message.count("\n") == 1
    assert not (logged / "read" / "run.csv").exists()


@pytest.mark.parametrize(
    ("more", "expected"),
    [(("--u-um", "0"), "expected an uncertainty"), (("--z", "tip"), "meaning of Z")],
)
def test_evaluate_refuses_in_one_line(logged, capsys, more, expected):
    assert evaluated(logged, *more) == 2
    message = capsys.readouterr().err
    assert expected in message
    assert message.count("\n") == 1
    assert not (logged / "read" / "run.csv").exists()


def test_temperatures_by_the_clock_come_with_the_run(logged):
    sensors = logged / "sensors.csv"
    rows = [f"{FIRST_MORNING + timedelta(minutes=k):%Y-%m-%dT%H:%M:%S},{20 + k}" for k in (0, 60)]
    sensors.write_text("\n".join(["clock,T_ram_degC", *rows]) + "\n", encoding="utf-8")
    assert evaluated(logged, "--sensors", str(sensors)) == 0
    touches = read_run(logged / "read" / "run.csv").touches
    started = np.round(touches.temperature["ram"] - 20.0 - touches.time / 60.0, 3)
    assert np.ptp(started) < 0.002  # a kelvin a minute from the start of the first program


@pytest.mark.slow  # the run with an effect is tested above, the diagnosis in its own room
def test_a_planted_effect_is_found_and_named(folder, golden, small):
    """Planted by its own formula in the exact machine, found by the diagnosis from the run file."""
    wanted = golden.requests(small, each=8)
    options = PlanOptions(tolerated=len(wanted))
    plan = plan_touches(small, golden.machine(), Probe(), golden.setup(), wanted, options)
    made = make_programs(plan)
    made.write(folder / "programs")
    names = [program.name for program in made.programs]
    planted = "thermal-lag(EZZ)=60um,tau=15min"
    more = ("--add", planted, "--noise-um", "0.5", "--seed", "3")
    assert command(folder, *more, programs=names) == 0
    run, out = str(folder / "out" / "run.csv"), str(folder / "found")
    assert main(["diagnose", run, *NARROW, "-o", out]) == 0
    found = json.loads((folder / "found" / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["verdict"] == "missing effect"
    step = found["steps"][1]
    assert "thermal-lag(EZZ)" in {step["effect"], *step["cannot_be_told_from"]}
    for name, size in (("tau_min", 15.0), ("amplitude_um", 60.0)):
        assert abs(step["parameters"][name] - size) < 3.0 * step["uncertainty"][name]


def test_what_the_sensors_read_stands_in_the_run_file_and_drives_the_effect(folder):
    rows = [f"2031-05-06T07:{minute:02d}:00,{20 + minute}" for minute in range(40)]
    sensors = folder / "sensors.csv"
    sensors.write_text("\n".join(["clock,T_ram_degC", *rows]) + "\n", encoding="utf-8")
    planted = "artefact-expansion(ram)=1000um/(m K)"
    more = ("--sensors", str(sensors), "--noise-um", "0")
    assert command(folder, *more, "--add", planted) == 0
    run = read_run(folder / "out" / "run.csv")
    warmth = run.touches.temperature["ram"]
    # a degree a minute, seconds of the log's clock rounded down
    assert (
        np.abs(warmth - (warmth[0] + (run.touches.time - run.touches.time[0]) / 60.0)).max() < 0.02
    )
    assert np.abs(run.deviation).max() > 10.0 * UM
    assert command(folder, *more, "--force") == 0
    assert np.abs(read_run(folder / "out" / "run.csv").deviation).max() < NM


def left(run):
    """What a set-up alone leaves of a run of a perfect machine, mm."""
    return np.abs(fit_run(run, Model(run.touches.chain, ())).residual).max()


def test_a_standard_that_is_warm(folder, capsys):
    """The twin's surfaces are 10.5e-6 * 10 K larger; what is taken off follows from points alone.

    At a steep place a surface 20 um beside meets the ball 20 um aside: second order, nanometres.
    """
    warm = ("--body-degC", "30", "--noise-um", "0")
    assert command(folder, *warm, "--logs", str(folder / "logs")) == 0
    assert "was at 30.0 ± 0.3 °C: its growth of +105.0 ppm" in capsys.readouterr().out
    path = folder / "out" / "run.csv"
    known = read_run(path)
    assert known.touches.setups[0].body == Body(10.5e-6, pytest.approx(1.05e-6), 0.3, True)
    assert left(known) < 20.0 * NM
    text = path.read_text(encoding="utf-8")
    path.write_text(re.sub("# standard = .*\n", "", text), encoding="utf-8")
    free = replace(known, touches=read_run(path).touches)
    assert left(read_run(path)) > 1.0 * UM
    assert left(free) < 20.0 * NM  # and not because a size was free in the fit
    # the logs know no temperature: by option, or in doubt
    assert evaluated(folder) == 0
    assert (
        "20 ± 2 °C is assumed, which leaves a standard uncertainty of 21.0 ppm"
        in capsys.readouterr().out
    )
    unknown = read_run(folder / "read" / "run.csv")
    assert np.abs(unknown.deviation - read_run(path).deviation).max() < NM
    assert evaluated(folder, "--body-degC", "30", "--body-u-K", "0.1", "--force") == 0
    assert "30.0 ± 0.1 °C" in capsys.readouterr().out
    assert np.abs(read_run(folder / "read" / "run.csv").deviation - known.deviation).max() < NM


def test_a_thermometer_on_the_standard_counts_touch_by_touch(folder, capsys):
    """30 degC by the record are those of the option."""
    assert command(folder, "--body-degC", "30", "--noise-um", "0", "--logs", f"{folder}/logs") == 0
    sensors = folder / "sensors.csv"
    times = (FIRST_MORNING - timedelta(hours=1), FIRST_MORNING + timedelta(hours=9))
    rows = [f"{at.isoformat()},30.0" for at in times]
    sensors.write_text("\n".join(["clock,T_body_degC", *rows]) + "\n", encoding="utf-8")
    assert evaluated(folder, "--sensors", str(sensors)) == 0
    assert "was at 30.0 ± 0.3 °C" in capsys.readouterr().out
    read, made = (read_run(folder / name / "run.csv") for name in ("read", "out"))
    assert np.abs(read.deviation - made.deviation).max() < NM
    apart = ("--sensors", str(sensors), "--body-degC", "22", "--force")
    assert evaluated(folder, *apart) == 2
    assert "body_degC: found 22, where T_body_degC is 30.00" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "output"),
    [
        (("--body-degC", "295"), "--body-degC 295 (in kelvin?): expected the temperature of"),
        (("--body-degC", "25", "--body-u-K", "-1"), "--body-u-K -1: expected a standard unc"),
        (("--body-u-K", "1"), "--body-u-K 1: expected --body-degC as well"),
    ],
)
def test_a_temperature_that_cannot_be(folder, capsys, more, output):
    assert command(folder, *more) == 2
    assert output in capsys.readouterr().err
    assert not (folder / "out").exists()


def test_a_standard_that_stands_beside_its_place(folder):
    """The set-up is fitted, and nothing of it is left in the deviations."""
    assert command(folder, "--setup-error", "X=0.2mm,C=0.05deg", "--noise-um", "0") == 0
    displaced = read_run(folder / "out" / "run.csv")
    assert np.abs(displaced.deviation).max() < 2.0 * NM
