"""Effects with sizes as users write them: units by hand, and what is refused."""

import numpy as np
import pytest

from matstd.twin.errors import DesignError
from matstd.twin.library import parse_sized_effect, parse_sizes
from matstd.twin.units import DEG


@pytest.mark.parametrize(
    ("text", "name", "theta", "tuning"),
    [
        ("backlash(X)=3um", "backlash(X)", [3e-3], {}),
        (" backlash(B) = -30 urad ", "backlash(B)", [-30e-6], {}),
        ("thermal-lag(EZZ)=25um,tau=18min", "thermal-lag(EZZ)", [0.025], {"tau": 1080.0}),
        ("thermal-lag(EZZ,nose)=2µm/K,tau=600s", "thermal-lag(EZZ,nose)", [2e-3], {"tau": 600.0}),
        ("location(EC0Y)=12um/m", "location(EC0Y)", [12e-6], {}),
        ("location(EC0Y)=1arcsec", "location(EC0Y)", [np.pi / 648000.0], {}),
        ("thermal-expansion(X,s)=11.5um/(m K)", "thermal-expansion(X,s)", [11.5e-6], {}),
        ("thermal-expansion(X,s)=11.5 ppm/K", "thermal-expansion(X,s)", [11.5e-6], {}),
        ("drift=X=2um/h,Z=-24um/d", "drift", [2e-3, 0.0, -1e-3], {}),
        ("probe-lobing=cos=2um,lobes=3", "probe-lobing", [2e-3, 0.0], {"lobes": 3.0}),
    ],
)
def test_sizes_in_base_units_by_hand(chain, text, name, theta, tuning):
    effect, found = parse_sized_effect(text, chain)
    assert effect.name == name
    assert found == pytest.approx(theta, rel=1e-12)
    assert dict(getattr(effect, "tuning", {})) == pytest.approx(tuning)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("backlash(X)", r"no size, expected for example backlash\(X\)=5um"),
        ("backlash(X)=3", "'3', expected a number with its unit, such as 5um"),
        ("backlash(X)=3s", "such as 5um"),
        ("backlash(X)=3parsec", "such as 5um"),
        ("backlash(X)=nanum", "such as 5um"),
        ("backlash(X)=1e300m", "within reason"),
        ("backlash(X)=3um,4um", "'amplitude' given twice"),
        ("backlash(X)=3um,tau=3s", "no parameter 'tau', expected NAME=SIZE, each of amplitude"),
        ("drift=2um/h", "a size without a name, expected NAME=SIZE, each of X, Y or Z"),
        ("thermal-lag(EZZ)=25um", r"incomplete, expected .*thermal-lag\(EZZ\)=5um,tau=18min"),
        ("thermal-lag(EZZ)=tau=18min", "incomplete"),
        ("back-lash(X)=3um", "did you mean backlash"),
    ],
)
def test_what_is_refused(chain, text, reason):
    with pytest.raises(DesignError, match=reason):
        parse_sized_effect(text, chain)


def test_sizes_by_name():
    found = parse_sizes("it", "X=0.3mm, C=0.05deg", {"X": "mm", "C": "rad"})
    assert found == pytest.approx({"X": 0.3, "C": 0.05 * DEG})
