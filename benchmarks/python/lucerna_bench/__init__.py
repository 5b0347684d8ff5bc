# SPDX-License-Identifier: Apache-2.0
"""Adapters to enter Lucerna Bench from Python: surfaces from functions, submission files, the scorer.

Needs numpy only. Lengths are in mm, in the frame of the task (benchmarks/README.md)."""
from .entry import Entry, Stated, score, write_submission
from .surfaces import cylinder_wall, extruded_profile, height_field, placed

__all__ = ["Entry", "Stated", "cylinder_wall", "extruded_profile", "height_field", "placed", "score",
           "write_submission"]
