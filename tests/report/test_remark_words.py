"""Sentences of remarks: numbers in their units, singular and plural, every record has one."""

from typing import get_args

import pytest

from matstd.diagnosis.fit import MistakenUnit, UnitMistake
from matstd.diagnosis.remarks import Noticed, Remark, What, noticed
from matstd.report.words import remark_sentence
from matstd.report.words.remark_words import _SENTENCES
from matstd.twin.units import UM


def test_every_remark_has_its_sentence() -> None:
    assert set(_SENTENCES) == {*get_args(Remark), *What} - {Noticed}


@pytest.mark.parametrize("what", MistakenUnit)
def test_every_mistaken_unit_has_its_sentence(what) -> None:
    message = remark_sentence(UnitMistake(what, 0.012 * UM, 12.0 * UM, 0.6 * UM, 0.5 * UM))
    assert "µm" in message
    assert "look like" in message or "looks like" in message


def test_lengths_are_in_micrometres() -> None:
    remark = remark_sentence(noticed(What.NOISE_MISSTATED, found=0.45 * UM, stated=0.6 * UM))
    assert remark == "touches scatter by 0.45 µm about the model; the stated noise is 0.60 µm"


def outliers(lines, largest, runs=()):
    what = What.OUTLIERS_LEFT_OUT
    return remark_sentence(noticed(what, lines=lines, largest=largest, runs=runs))


def test_one_outlier_and_many() -> None:
    one = outliers((17,), 31.04 * UM)
    assert one.startswith("1 gross error was left out, 31.0 µm outside the prediction of")
    assert one.endswith(": line 17")
    years = outliers((7, 9, 8), 30.0 * UM, ("2019", "2026", "2019"))
    assert years.endswith("touches: lines 7, 8 of 2019; line 9 of 2026")
    many = outliers(tuple(range(1, 24)), -12.0 * UM)
    assert many.startswith("23 gross errors were left out, the largest 12.0 µm inside")
    assert many.endswith("19, 20 and 3 more")


def poses(count, has_rotary=True):
    return remark_sentence(noticed(What.FEW_POSES, poses=count, has_rotary=has_rotary))


def test_one_pose_and_two() -> None:
    assert poses(1).startswith("only 1 table pose: errors of the rotary axes c")
    assert "cannot be determined" in poses(1)
    assert "only 2 table poses" in poses(2)
    stood = remark_sentence(noticed(What.JOINTS_STOOD, names=("A", "C1")))
    assert "A and C1 did not move in any pose" in stood
    assert poses(1, False).startswith("only 1 pose: rows are held out in")
    assert "1500 sets" in remark_sentence(noticed(What.SEARCH_ENDED, sets=1500.0))
