"""A comparison on every machine of the simulator is what it was, its mistakes in numbers too."""

import pytest
from simulator_experiment import MACHINES
from unchanged import table_text

from matstd.diagnosis.answer import compare
from matstd.diagnosis.files import comparison_table


@pytest.mark.parametrize("machine", MACHINES)
def test_the_comparison_is_what_it_was(case, machine, unchanged) -> None:
    run = case(4, machine, ("backlash(X)",), True).run
    unchanged(table_text(comparison_table(compare(run[::2]))))
