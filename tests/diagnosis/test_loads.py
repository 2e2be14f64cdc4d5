"""What touches of 1 N can say of stiffness: nothing, and that is said; known loads identify it."""

from dataclasses import replace

import numpy as np
from made_up import made_up

from matstd.diagnosis.fit import Role, fit_run, reported
from matstd.diagnosis.remarks import What, remarks
from matstd.report.words import remark_sentence
from matstd.twin.library import parse_effect
from matstd.twin.model import Model, columns
from matstd.twin.record import Run
from matstd.twin.units import UM


def fitted(load, texts, seed=3):
    rng = np.random.default_rng(seed)
    touches = made_up("hsm600u")
    direction = rng.normal(size=(len(touches), 3))
    force = load * direction / np.linalg.norm(direction, axis=1)[:, None]
    touches = replace(touches, force=force)
    model = Model(touches.chain, tuple(parse_effect(t, touches.chain) for t in texts))
    theta = model.prior_sd
    noise = 1.0 * UM
    run = Run(
        touches,
        model.columns(touches) @ theta + noise * rng.normal(size=len(touches)),
        np.full(len(touches), noise),
    )
    return fit_run(run, model), theta


def said(fit, kind):
    return [r for r in remarks(fit) if getattr(r, "what", None) is kind]


def test_touches_of_one_newton_do_not_identify_a_stiffness():
    fit, _ = fitted(1.0, ["stiffness(Z)"])
    (remark,) = said(fit, What.LOAD_TOO_SMALL)
    assert remark.load == 1.0 or abs(remark.load - 1.0) < 1e-9
    assert "1 N are too small to identify stiffness(Z)" in remark_sentence(remark)


def test_known_loads_do():
    fit, theta = fitted(300.0, ["stiffness(Z)", "tool-point-stiffness(X,Y)"])
    assert not said(fit, What.LOAD_TOO_SMALL)
    rows = [p for p, (e, _) in enumerate(fit.parameters) if e.kind == "tool-point-stiffness"]
    left = (fit.theta[rows] - theta[1:]) / np.sqrt(np.diag(fit.covariance)[rows])
    assert np.sqrt(np.mean(left**2)) < 1.6
    assert np.diag(fit.covariance)[rows][0] < (0.5 * theta[1]) ** 2


def test_a_compliance_is_reported_by_what_it_explains():
    """Some of its entries are known by belief alone; its size is known all the same."""
    fit, theta = fitted(300.0, ["tool-point-stiffness(X,Y)"])
    effect = next(e for e in fit.effects if e.kind == "tool-point-stiffness")
    size = next(r for r in reported(fit, effect) if r.role is Role.SIZE)
    bent = columns([effect], fit.run.touches)[fit.used] @ theta
    assert size.quantity == "rms"
    assert abs(size.value - np.sqrt(np.mean(bent**2)) / UM) < 3.0 * size.u < 1.0


def test_a_beam_that_is_too_short_is_reported():
    fit, _ = fitted(1.0, ["beam(Z,cantilever,300x300,at:500)"])
    (remark,) = said(fit, What.SHORT_BEAM)
    assert "times as long as deep" in remark_sentence(remark)
