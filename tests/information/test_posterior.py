"""What touches can know: against formulas, simulated estimates and known gauge freedoms."""

import numpy as np
import pytest

from matstd.information.criteria import Posterior, prior_sd_of_tip, whitened
from matstd.information.identifiability import identifiability
from matstd.sensitivity.first_order import latin_hypercube
from matstd.sensitivity.population import Population
from matstd.twin.errors import ShapeMismatch
from matstd.twin.machine import table_to_tool, tip
from matstd.twin.record import Setup, Touches, at_poses

LENGTH = 160.0
NOISE = 1e-3  # mm


@pytest.fixture(scope="module")
def scatter(chain, workspace):
    """Touches at random poses with random normals within 75 degrees of the tool."""
    rng = np.random.default_rng(12)
    q = latin_hypercube(workspace, 1500, rng)
    normal = rng.normal(size=(1500, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    axis = table_to_tool(chain, q)[:, :3, 2]
    reachable = np.einsum("ni,ni->n", normal, axis) > np.cos(np.radians(75.0))
    q, normal = q[reachable][:500], normal[reachable][:500]
    n = len(q)
    return Touches(
        chain=chain,
        q=q,
        length=np.full(n, LENGTH),
        radius=np.zeros(n),
        point=tip(chain, q, LENGTH),
        normal=normal,
        setups=(Setup("a"),),
        setup=np.zeros(n, dtype=np.int64),
        time=np.zeros(n),
        approach=np.zeros(q.shape),
    )


def small_posterior(rng, rows=7, parameters=5):
    A = rng.normal(size=(rows, parameters))
    sd, u = rng.uniform(0.5, 2.0, parameters), rng.uniform(0.1, 1.0, rows)
    return A, sd, u, Posterior(whitened(A, sd, u), sd, tuple("abcde"))


def test_posterior_is_that_of_the_textbook():
    rng = np.random.default_rng(1)
    A, sd, u, posterior = small_posterior(rng)
    expected = np.linalg.inv(np.diag(sd**-2) + A.T @ np.diag(u**-2) @ A)
    np.testing.assert_allclose(posterior.covariance, expected, rtol=1e-10)
    np.testing.assert_allclose(posterior.sd, np.sqrt(np.diag(expected)), rtol=1e-10)
    G = rng.normal(size=(4, 3, 5))
    each = [np.sqrt(np.trace(g @ expected @ g.T)) for g in G]
    np.testing.assert_allclose(posterior.predicted_sd(G), each, rtol=1e-10)
    np.testing.assert_allclose(
        prior_sd_of_tip(G, sd), [np.sqrt(np.trace(g @ np.diag(sd**2) @ g.T)) for g in G]
    )
    values, vectors = posterior.spectrum
    _, singular, directions = np.linalg.svd(A / u[:, None] * sd)
    np.testing.assert_allclose(values, singular, rtol=1e-9)
    np.testing.assert_allclose(np.abs(directions @ vectors), np.eye(5), atol=1e-9)
    shrunk = 1.0 - np.diag(expected @ np.diag(sd**-2))
    assert posterior.degrees_of_freedom == pytest.approx(shrunk.sum(), rel=1e-10)


def test_one_touch_of_two_parameters_by_hand():
    # W = (1 * 1 / 0.5, 2 * 2 / 0.5) = (2, 8), 1 + W^T W = (5, 16; 16, 65), determinant 69
    sd = np.array([1.0, 2.0])
    posterior = Posterior(whitened(np.array([[1.0, 2.0]]), sd, 0.5), sd, ("a", "b"))
    np.testing.assert_allclose(posterior.W, [[2.0, 8.0]])
    np.testing.assert_allclose(posterior.covariance, np.array([[65.0, -32.0], [-32.0, 20.0]]) / 69)
    assert posterior.degrees_of_freedom == pytest.approx(68.0 / 69.0)
    values, vectors = posterior.spectrum
    np.testing.assert_allclose(values, [np.sqrt(68.0), 0.0], atol=1e-12)
    np.testing.assert_allclose(np.abs(vectors[:, 0]), np.array([2.0, 8.0]) / np.sqrt(68.0))
    assert posterior.alone == ("b",)  # 20/69 of 4 is below a tenth, 65/69 of 1 is not


def test_predicted_uncertainty_is_that_of_simulated_estimates(chain, scatter, workspace):
    model = Population(chain).model
    A = model.columns(scatter)
    posterior = Posterior(whitened(A, model.prior_sd, NOISE), model.prior_sd, model.names)
    G = model.tip_columns(
        at_poses(chain, latin_hypercube(workspace, 40, np.random.default_rng(2)), LENGTH)
    )
    said = posterior.predicted_sd(G)
    rng = np.random.default_rng(3)
    draws = 400
    theta = rng.normal(size=(draws, len(model.prior_sd))) * model.prior_sd
    measured = theta @ A.T + rng.normal(0.0, NOISE, (draws, len(A)))
    estimate = measured @ A @ posterior.covariance / NOISE**2
    missed = np.einsum("nik,sk->nsi", G, theta - estimate)
    seen = np.sqrt(np.mean(np.sum(missed**2, axis=2), axis=1))
    # 400 machines know a root mean square to 2 to 4 %
    np.testing.assert_allclose(seen, said, rtol=0.15)
    assert np.mean(seen / said) == pytest.approx(1.0, abs=0.03)
    assert said.max() < 0.1 * prior_sd_of_tip(G, model.prior_sd).min()


def test_gauge_freedoms_of_the_machine_are_named(chain, scatter):
    model = Population(chain).model
    W = whitened(model.columns(scatter), model.prior_sd, NOISE)
    found = identifiability(W, model.prior_sd, model.names)
    assert found.parameters == len(model.names)
    assert found.rank + len(found.freedoms) == found.parameters
    length = np.linalg.norm(W, axis=0)
    loud = length > 1e-9 * length.max()
    singular = np.linalg.svd(W[:, loud] / length[loud], compute_uv=False)
    assert found.rank == int(np.sum(singular > 1e-8 * singular[0]))
    values = {f.parameter: f.values for f in found.freedoms}
    # a roll about the tool moves no ball on the tool axis
    assert values["geometric(ECZ,linear)"] == {}
    # pitch of Z is a straightness at one tool length
    tilt = values["geometric(EBZ,linear)"]
    assert tilt["geometric(EXZ,linear)"] == pytest.approx(-160.0)
    # squareness of Y to X is a linear straightness: -EC0Y y = a y / 300
    assert values["location(EC0Y)"]["geometric(EXY,linear)"] == pytest.approx(-300.0)
    # zero of X and radial error of the still spindle
    assert values["location(EX0X)"]["geometric(EXC1,constant)"] == pytest.approx(1.0)


def test_freedoms_hold_exactly(chain, scatter):
    model = Population(chain).model
    A = model.columns(scatter)
    found = identifiability(whitened(A, model.prior_sd, NOISE), model.prior_sd, model.names)
    names = list(model.names)
    for freedom in found.freedoms:
        column = A[:, names.index(freedom.parameter)]
        made = sum((v * A[:, names.index(n)] for n, v in freedom.values.items()), np.zeros(len(A)))
        # terms below a thousandth are left out of the words
        assert np.linalg.norm(column - made) <= 5e-3 * max(np.linalg.norm(column), 1e-9)


def test_columns_that_hardly_differ_are_not_called_equal():
    rng = np.random.default_rng(4)
    a = rng.normal(size=100)
    b = a + 1e-4 * rng.normal(size=100)
    W = np.stack([a, b, 3.0 * a], axis=1)
    found = identifiability(W, np.ones(3), ("a", "b", "c"))
    assert found.rank == 2
    assert [(f.parameter, f.values) for f in found.freedoms] == [("c", {"a": pytest.approx(3.0)})]
    assert found.condition == pytest.approx(2e4, rel=0.2)


def test_known_alone_means_variance_down_tenfold():
    posterior = Posterior(np.diag([3.01, 2.99, 0.0]), np.ones(3), ("a", "b", "c"))
    assert posterior.alone == ("a",)  # 1 + 3^2 = 10


def test_rows_and_prior_must_belong_together():
    with pytest.raises(ShapeMismatch, match=r"expected \(N, 4\)"):
        whitened(np.zeros((5, 3)), np.ones(4), 1.0)
