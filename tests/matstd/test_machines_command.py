"""`matstd machines`: every file is read, every figure has its source and is the paper's."""

import re

import numpy as np
import pytest

from matstd.api.machines import machine_names
from matstd.commands.machine.machines import text
from matstd.twin.files import read_errors, read_machine
from matstd.twin.model import Model
from matstd.twin.record import at_poses
from matstd.twin.units import UM


def written(name, folder):
    for errors, file in ((False, "m.toml"), (True, "e.toml")):
        (folder / file).write_text(text(name, errors), encoding="utf-8")
    chain = read_machine(folder / "m.toml")
    return chain, read_errors(folder / "e.toml", chain)


@pytest.mark.parametrize("name", machine_names())
def test_files_are_read_and_every_figure_has_its_source(name, tmp_path):
    chain, _ = written(name, tmp_path)
    assert set(chain.linear_axes) == {"X", "Y", "Z"}
    assert not chain.remarks
    for errors in (False, True):
        for line in text(name, errors).splitlines():
            if re.match(r"(chain|range|point|origin|E\w+) =", line):
                assert "  #" in line or " # " in line, line


def test_the_machine_of_1995_is_as_published(tmp_path):
    """90 µm in 750 mm of X; 157 µm in 500 mm of Z at the height of the spindle line."""
    chain, errors = written("hmc1995", tmp_path)
    model = Model(chain, tuple(e for e, _ in errors))
    for axis, symbol, ends, published in (
        ("X", "EXX", (-375.0, 375.0), 90 * UM),
        ("Z", "EZZ", (-500.0, 0.0), 157 * UM),
    ):
        theta = np.concatenate([t * (e.symbol.name == symbol) for e, t in errors])
        q = np.zeros((2, len(chain.axes)))
        q[:, chain.axis_index(axis)] = ends
        moved = model.tip_deviation(at_poses(chain, q, 0.0), theta)
        np.testing.assert_allclose(np.abs(moved[1] - moved[0]).max(), published, rtol=1e-3)


def test_a_machine_that_is_not_included(refusal):
    assert "did you mean hmc1995?" in refusal(["machines", "hmc1996"])
