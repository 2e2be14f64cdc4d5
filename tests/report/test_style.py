"""One style: colours that do not repeat, labels, scales."""

import re

import numpy as np
import pytest
from figures import DOT

from matstd.report.style import figure, robust_limit, save, series


def test_no_colour_comes_twice() -> None:
    """More things than the palette has still differ, and by more than rounding."""
    found = [tuple(int(series(k)[i : i + 2], 16) for i in (1, 3, 5)) for k in range(60)]
    assert all(re.fullmatch("#[0-9a-f]{6}", series(k)) for k in range(60))
    apart = min(max(abs(np.subtract(a, b))) for i, a in enumerate(found) for b in found[:i])
    assert apart >= 4
    first = min(max(abs(np.subtract(a, b))) for i, a in enumerate(found[:12]) for b in found[:i])
    assert first > 40


def test_a_scale_that_few_values_do_not_decide() -> None:
    values = np.concatenate([np.linspace(-1.0, 1.0, 999), [500.0]])
    assert robust_limit(values) < 1.01
    assert robust_limit(np.zeros(3)) == 1.0


@pytest.mark.usefixtures("unrendered")
def test_an_unrendered_figure_is_a_dot(tmp_path) -> None:
    """Were it rendered, tests of pages would take twice as long and fail nowhere."""
    save(figure(1.0), tmp_path / "picture.png")
    assert (tmp_path / "picture.png").read_bytes() == DOT
