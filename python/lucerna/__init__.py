# SPDX-License-Identifier: Apache-2.0
"""Lucerna: illumination design with mirrors, from ray file to reflector.

Lengths are in mm, angles in degrees, flux in lm or W, intensity in cd or W/sr. What came from rays is an
`Estimate` with its standard error. Classes never change once made, so threads may share their objects.
"""
from . import _core, _methods
from ._core import (DesignResult, IntensityDistribution, PlaneImage, RaySet, Reflector, Scene, SourceModel,
                    TraceResult, __version__)
from ._design import Objective, design
from ._methods import (build_info, compare, compare_held_out, compress, make_source, merge, read_intensity,
                       read_model, read_rays, read_trace, write_report)
from ._toml import Body, Detector, Source
from ._types import Estimate, InputError, Record

for _name in (DesignResult, IntensityDistribution, PlaneImage, RaySet, Reflector, Scene, SourceModel, TraceResult,
              build_info, compare_held_out, compress, make_source, merge, read_intensity, read_model, read_rays,
              read_trace, write_report, Objective, design, compare, Body, Detector, Source, Estimate, InputError, Record):
    if isinstance(_name, type) or hasattr(_name, "__dict__"):
        _name.__module__ = "lucerna"
del _name
_core._seal()

__all__ = ["Body", "DesignResult", "Detector", "Estimate", "InputError", "IntensityDistribution", "Objective",
           "PlaneImage", "RaySet", "Record", "Reflector", "Scene", "Source", "SourceModel", "TraceResult",
           "__version__", "build_info", "compare", "compare_held_out", "compress", "design", "make_source", "merge",
           "read_intensity", "read_model", "read_rays", "read_trace", "write_report"]
