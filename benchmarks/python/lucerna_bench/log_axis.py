# SPDX-License-Identifier: Apache-2.0
"""Where numbers stand on a logarithmic axis of a picture."""
import math


class Axis:
    """A logarithmic one, from decade to decade of what is on it."""

    def __init__(self, values, low_px, high_px):
        self.low = math.floor(math.log10(min(values)))
        self.high = max(self.low + 1, math.ceil(math.log10(max(values)) - 1e-9))
        self.low_px, self.high_px = low_px, high_px

    def __call__(self, value):
        share = (math.log10(value) - self.low) / (self.high - self.low)
        return self.low_px + (self.high_px - self.low_px) * share

    @property
    def decades(self):
        return [10.0**k for k in range(self.low, self.high + 1)]
