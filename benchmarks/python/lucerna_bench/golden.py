# SPDX-License-Identifier: Apache-2.0
"""Golden section search: J. Kiefer, "Sequential Minimax Search for a Maximum", Proc. AMS 4, 502 (1953)."""


def golden_section(cost, low, high, over):
    """The best place that was tried of a function with one minimum, until `over(trials)` says so, asked before each
    trial but the first two."""
    share = 0.5 * (5.0**0.5 - 1.0)
    tried = {}

    def at(x):
        tried[x] = cost(x)
        return tried[x]

    a, b = high - share * (high - low), low + share * (high - low)
    at_a, at_b = at(a), at(b)
    while not over(len(tried)):
        if at_a < at_b:
            high, b, at_b = b, a, at_a
            a = high - share * (high - low)
            at_a = at(a)
        else:
            low, a, at_a = a, b, at_b
            b = low + share * (high - low)
            at_b = at(b)
    return min(tried, key=tried.get)
