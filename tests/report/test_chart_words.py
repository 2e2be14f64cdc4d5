"""Sentences of control charts: sizes and uncertainties as worked out by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from matstd.diagnosis.charts import Drift
from matstd.diagnosis.geometry import Estimate
from matstd.report.charts import chart_words
from matstd.twin.units import URAD


@pytest.mark.parametrize(
    ("is_dated", "pace"), [(True, "-4.2 ± 1.4 µrad a week"), (False, "-0.60 ± 0.20 µrad from run")]
)
def test_a_drift_has_its_uncertainty_over_the_same_time(is_dated, pace):
    """0.6 ± 0.2 µrad a day over ten days are 6 ± 2 µrad."""
    drift = Drift(rate=Estimate(-0.6 * URAD, 0.2 * URAD), p_value=1e-5)
    found = SimpleNamespace(days=np.array([0.0, 4.0, 10.0]), is_dated=is_dated)
    said = chart_words.drift_words(found, drift, "rad")
    assert f"drifts by {pace}" in said
    assert "-6.0 ± 2.0 µrad in all" in said
