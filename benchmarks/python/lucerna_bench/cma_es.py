# SPDX-License-Identifier: Apache-2.0
"""CMA-ES: the covariance matrix adaptation evolution strategy.

Written from the equations of N. Hansen, "The CMA Evolution Strategy: A Tutorial", arXiv 1604.00772 (2016), with its
default rates, positive recombination weights, and restarts with a doubled population after A. Auger and N. Hansen, "A
Restart CMA Evolution Strategy With Increasing Population Size", CEC 2005."""
import dataclasses

import numpy as np


@dataclasses.dataclass(frozen=True)
class Found:
    """The best that a search met."""
    parameters: np.ndarray
    cost: float
    evaluations: int


class _State:
    """One run of the strategy: its distribution, and how the best of a population change it."""

    def __init__(self, start, sigma, population, random, adapt_covariance):
        n = len(start)
        self.mean, self.sigma, self.random, self.adapt = start.copy(), sigma, random, adapt_covariance
        self.population = population
        raw = np.log(0.5 * (population + 1)) - np.log(np.arange(1, population // 2 + 1))
        self.weights = raw / raw.sum()
        mu = self.mu_eff = 1.0 / np.sum(self.weights**2)
        self.c_sigma = (mu + 2.0) / (n + mu + 5.0)
        self.damping = 1.0 + 2.0 * max(0.0, np.sqrt((mu - 1.0) / (n + 1.0)) - 1.0) + self.c_sigma
        self.c_path = (4.0 + mu / n) / (n + 4.0 + 2.0 * mu / n)
        self.c_one = 2.0 / ((n + 1.3) ** 2 + mu)
        self.c_mu = min(1.0 - self.c_one, 2.0 * (0.25 + mu + 1.0 / mu - 2.0) / ((n + 2.0) ** 2 + mu))
        self.mean_norm = np.sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n))
        self.path_sigma, self.path_c = np.zeros(n), np.zeros(n)
        self.covariance, self.axes, self.lengths = np.eye(n), np.eye(n), np.ones(n)
        self.generation = 0

    def ask(self):
        z = self.random.standard_normal((self.population, len(self.mean)))
        return self.mean + self.sigma * (z * self.lengths) @ self.axes.T

    def tell(self, points, costs):
        n = len(self.mean)
        self.generation += 1
        steps = (points[np.argsort(costs)[:len(self.weights)]] - self.mean) / self.sigma
        step = self.weights @ steps
        self.mean = self.mean + self.sigma * step
        white = self.axes @ ((self.axes.T @ step) / self.lengths)
        self.path_sigma = ((1.0 - self.c_sigma) * self.path_sigma
                           + np.sqrt(self.c_sigma * (2.0 - self.c_sigma) * self.mu_eff) * white)
        norm = np.linalg.norm(self.path_sigma)
        bias = np.sqrt(1.0 - (1.0 - self.c_sigma) ** (2 * self.generation))
        moves = norm / bias < (1.4 + 2.0 / (n + 1.0)) * self.mean_norm
        self.path_c *= 1.0 - self.c_path
        if moves:
            self.path_c += np.sqrt(self.c_path * (2.0 - self.c_path) * self.mu_eff) * step
        if self.adapt:
            self._adapt_covariance(steps, moves)
        self.sigma *= np.exp(self.c_sigma / self.damping * (norm / self.mean_norm - 1.0))

    def _adapt_covariance(self, steps, moves):
        stalled = 0.0 if moves else self.c_one * self.c_path * (2.0 - self.c_path)
        rank_mu = (self.weights[:, None] * steps).T @ steps
        self.covariance = ((1.0 - self.c_one - self.c_mu + stalled) * self.covariance
                           + self.c_one * np.outer(self.path_c, self.path_c) + self.c_mu * rank_mu)
        values, self.axes = np.linalg.eigh(0.5 * (self.covariance + self.covariance.T))
        self.lengths = np.sqrt(np.maximum(values, 1e-20 * values[-1]))

    def spent(self, tolerance):
        """No step is left that matters, or numbers end."""
        return self.sigma * self.lengths.max() < tolerance or self.lengths.max() > 1e7 * self.lengths.min()


def minimise(cost, start, sigma, stop, seed=1, tolerance=1e-10, adapt_covariance=True):
    """The best that is found until `stop(evaluations, best cost)` says so, asked before each evaluation but the first,
    which is the start itself. `sigma`: the scatter to begin with. Without `adapt_covariance` only the length of steps
    is adapted: a broken variant for tests."""
    start, random = np.asarray(start, float), np.random.default_rng(seed)
    population = 4 + int(3.0 * np.log(len(start)))
    best, best_cost, evaluations = start.copy(), cost(start), 1
    while True:
        state = _State(start, sigma, population, random, adapt_covariance)
        while not state.spent(tolerance):
            points, costs = state.ask(), []
            for point in points:
                if stop(evaluations, best_cost):
                    return Found(best, best_cost, evaluations)
                costs.append(cost(point))
                evaluations += 1
                if costs[-1] < best_cost:
                    best, best_cost = point.copy(), costs[-1]
            state.tell(points, np.array(costs))
        population *= 2
