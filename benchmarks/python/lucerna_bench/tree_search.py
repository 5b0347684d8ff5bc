# SPDX-License-Identifier: Apache-2.0
"""A search tree that closes in with pattern search: our reading of chapter 5 of A. Mas, "Optimization of Inverse
Reflector Design" (thesis, Girona 2010).

What is known of it: parameter ranges get narrower at each level of the tree; a node scores cells of its ranges and
takes one cell as its child; branches are explored one at a time; a local search after R. Hooke and T. A. Jeeves,
"'Direct Search' Solution of Numerical and Statistical Problems", J. ACM 8, 212 (1961), closes in at the end of a
branch. How nodes are chosen and weights act is not known; here:

- Each parameter's range has three cells that overlap by half. A child has one cell of each parameter, half as wide.
- A cell's score is the mean cost of what was seen in it. It is taken with a probability that goes with
  exp(-3 (score - best) / (worst - best)); one not yet seen counts as the best.
- After four levels the pattern search begins in the middle of the last node; what it finds scores cells of all nodes
  above."""
import numpy as np

from .cma_es import Found

LEVELS, CELLS, GREED = 4, 3, 3.0


class _Stop(Exception):
    pass


class _Node:
    def __init__(self, low, high):
        self.low, self.high = low, high
        self.sums, self.counts = np.zeros((CELLS, len(low))), np.zeros((CELLS, len(low)))
        self.children = {}

    def learn(self, point, cost):
        """Cells that hold the point: cell k of a range reaches from k / 4 to (k + 2) / 4 of it."""
        at = (point - self.low) / (self.high - self.low)
        for k in range(CELLS):
            held = (at >= 0.25 * k) & (at <= 0.25 * (k + 2))
            self.sums[k] += np.where(held, cost, 0.0)
            self.counts[k] += held

    def pick(self, random):
        """One cell of each parameter."""
        seen = self.counts > 0
        score = np.where(seen, self.sums / np.maximum(self.counts, 1), np.nan)
        # The start is in a cell of every parameter, and so is each point of a branch: none is wholly unseen.
        best, worst = np.nanmin(score, axis=0), np.nanmax(score, axis=0)
        span = np.where(worst > best, worst - best, 1.0)
        weight = np.exp(-GREED * (np.where(seen, score, best) - best) / span)
        weight /= weight.sum(axis=0)
        return tuple((random.random(len(self.low)) > np.cumsum(weight, axis=0)).sum(axis=0).clip(0, CELLS - 1))

    def child(self, cells):
        if cells not in self.children:
            width = self.high - self.low
            low = self.low + 0.25 * np.array(cells) * width
            self.children[cells] = _Node(low, low + 0.5 * width)
        return self.children[cells]


def hooke_jeeves(cost, start, start_cost, step, shortest):
    """Exploratory and pattern moves from a point, until steps are shorter than `shortest` of the first ones."""
    def explore(point, value):
        point = point.copy()
        for i in range(len(point)):
            for way in (1.0, -1.0):
                tried = point.copy()
                tried[i] += way * delta[i]
                found = cost(tried)
                if found < value:
                    point, value = tried, found
                    break
        return point, value

    base, base_cost, delta = start, start_cost, step.copy()
    while np.any(delta > shortest * step):
        point, value = explore(base, base_cost)
        if value >= base_cost:
            delta *= 0.5
            continue
        while value < base_cost:
            ahead = point + (point - base)
            base, base_cost = point, value
            point, value = explore(ahead, cost(ahead))
    return base, base_cost


def minimise(cost, start, reach, stop, seed=1):
    """The best that is found within `reach` of the start (and by pattern moves beyond) until `stop(evaluations, best
    cost)` says so, asked before each evaluation but the first, which is the start itself."""
    start, random = np.asarray(start, float), np.random.default_rng(seed)
    root = _Node(start - reach, start + reach)
    best, path = [start.copy(), cost(start), 1], [root]

    def tried(point):
        if stop(best[2], best[1]):
            raise _Stop
        value = cost(point)
        best[2] += 1
        if value < best[1]:
            best[:2] = [np.array(point), value]
        for node in path:
            node.learn(point, value)
        return value

    root.learn(start, best[1])
    try:
        while True:
            path = [root]
            for _ in range(LEVELS):
                path.append(path[-1].child(path[-1].pick(random)))
                middle = 0.5 * (path[-1].low + path[-1].high)
                value = tried(middle)
            hooke_jeeves(tried, middle, value, 0.25 * (path[-1].high - path[-1].low), 0.1)
    except _Stop:
        return Found(best[0], best[1], best[2])
