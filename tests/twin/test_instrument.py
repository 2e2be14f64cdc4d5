"""Instruments other than a touching ball: what is not offered to them, and what stays."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import run_of

from matstd.twin.effects.backlash import measured_component
from matstd.twin.errors import BadFile
from matstd.twin.files import read_run
from matstd.twin.files.run_writer import run_text
from matstd.twin.library import proposals
from matstd.twin.record import Instrument

OF_A_BALL = {
    "probe-lobing",
    "probe-radius",
    "stylus-bending",
    "artefact-form",
    "artefact-expansion",
}


def words(touches):
    return {effect.name.split("(")[0] for effect in proposals(touches)}


@pytest.fixture
def run(case):
    return case(3).run


def test_a_ball_on_a_standard_is_offered_probe_and_standard(run):
    assert words(run.touches) >= OF_A_BALL - {"artefact-form", "artefact-expansion"}


@pytest.mark.parametrize("instrument", [i for i in Instrument if i is not Instrument.TOUCH_PROBE])
def test_other_instruments_are_not(run, instrument):
    touching, other = words(run.touches), words(replace(run.touches, instrument=instrument))
    assert not other & OF_A_BALL
    of_a_standard = set() if instrument.has_standard else {"artefact-slip"}
    if instrument.reads_angle:  # nor anything that moves without a turn
        of_a_standard |= {"drift", "thermal-expansion"}
    assert touching - other <= OF_A_BALL | of_a_standard, "everything else is offered all the same"
    assert "backlash" in other


def test_the_instrument_stands_in_the_head_of_a_run(run, tmp_path):
    """Written, read back; an unknown one is refused with those that are known."""
    chain = run.touches.chain
    laser = replace(run, touches=replace(run.touches, instrument=Instrument.LASER))
    path = tmp_path / "run.csv"
    path.write_text(run_text(laser, "machine.toml"), encoding="utf-8")
    assert read_run(path, chain).touches.instrument is Instrument.LASER
    assert "instrument" not in run_text(run, "machine.toml"), "a touch probe needs no word"
    path.write_text(
        path.read_text(encoding="utf-8").replace('"laser"', '"lidar"'), encoding="utf-8"
    )
    with pytest.raises(BadFile, match=r"instrument: found 'lidar', expected .*.tracker."):
        read_run(path, chain)


@pytest.mark.parametrize("across", [0, 1, 2])
def test_the_reversal_is_that_of_the_component_that_is_read(across) -> None:
    """A gauge beside an axis along X reads EXX, EYX or EZX, by its direction alone."""
    touches = run_of(np.arange(5.0), np.zeros(5)).touches
    seen = replace(touches, normal=np.tile(np.eye(3)[across], (5, 1)))
    assert measured_component(seen, "X") == across
