# SPDX-License-Identifier: Apache-2.0
"""The searches of the baselines on functions whose minimum is known."""
import numpy as np
import pytest
from lucerna_bench import cma_es, tree_search

N = 8


def ellipsoid(x):
    """Axes whose lengths differ by a thousand."""
    return float(np.sum(10.0 ** (6.0 * np.arange(N) / (N - 1)) * np.asarray(x) ** 2))


def evaluations_to(goal, cost, most=8000, **options):
    found = cma_es.minimise(cost, np.ones(N), 0.5, lambda n, best: best < goal or n >= most, **options)
    assert cost(found.parameters) == found.cost
    return found.evaluations


# Hansen's tutorial has about n * 150 evaluations for a sphere to 1e-9, and n^2 * 60 for this ellipsoid.
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_cma_es_needs_as_many_evaluations_as_published(seed):
    assert 500 < evaluations_to(1e-9, lambda x: float(x @ x), seed=seed) < 1900
    assert 2000 < evaluations_to(1e-9, ellipsoid, seed=seed) < 6000


def test_cma_es_without_its_covariance_is_told_apart():
    assert evaluations_to(1e-9, ellipsoid, seed=1, adapt_covariance=False) >= 8000
    # A sphere has no axes to learn: there the broken one is as good.
    assert evaluations_to(1e-9, lambda x: float(x @ x), seed=1, adapt_covariance=False) < 1900


def test_cma_es_restarts_when_a_run_is_spent():
    """Rastrigin's function: a run of few ends in one of its many basins, larger populations see the whole."""
    def cost(x):
        return float(np.sum(x * x + 10.0 - 10.0 * np.cos(2.0 * np.pi * x)))

    def found(most):
        done = lambda n, best: best < 1e-6 or n >= most
        return cma_es.minimise(cost, np.full(3, 3.2), 1.0, done, tolerance=1e-8, seed=1)

    assert found(600).cost > 0.5
    assert found(20_000).cost < 1e-6


def rosenbrock(x):
    x = np.asarray(x)
    return float(np.sum(100.0 * (x[1:] - x[:-1] ** 2) ** 2 + (1.0 - x[:-1]) ** 2))


@pytest.mark.parametrize("cost", [ellipsoid, rosenbrock, lambda x: float(np.sum(np.cos(7.0 * np.asarray(x))))])
@pytest.mark.parametrize("most", [1, 2, 17, 400])
def test_tree_never_ends_worse_than_it_began(cost, most):
    start = np.linspace(0.3, 1.1, N)
    found = tree_search.minimise(cost, start, np.full(N, 0.5), lambda n, best: n >= most, seed=most)
    assert found.cost <= cost(start)
    assert cost(found.parameters) == found.cost
    assert found.evaluations == most


def test_tree_finds_a_minimum_within_its_range():
    at = np.array([0.31, -0.77, 0.123])
    found = tree_search.minimise(lambda x: float(np.sum((x - at) ** 2)), np.zeros(3), np.ones(3),
                                 lambda n, best: n >= 1500)
    assert np.abs(found.parameters - at).max() < 0.02


def test_tree_learns_where_it_is_cheap():
    """Cells that cost more are taken less often: of the children of the root the cheap ones prevail."""
    seen = []

    def cost(x):
        seen.append(x[0])
        return abs(x[0] - 0.8)

    tree_search.minimise(cost, np.zeros(1), np.ones(1), lambda n, best: n >= 600)
    assert np.mean(np.array(seen) > 0.0) > 0.7


def test_pattern_moves_run_along_a_valley():
    def cost(x):
        return float((x[0] - x[1]) ** 2 * 100.0 + (x[0] + x[1] - 20.0) ** 2)

    counted = []
    best, value = tree_search.hooke_jeeves(lambda x: counted.append(1) or cost(x), np.zeros(2), cost(np.zeros(2)),
                                           np.full(2, 0.5), 1e-3)
    assert value < 1e-3 and np.abs(best - 10.0).max() < 0.1
    assert len(counted) < 400
