// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/objective.h"
#include "lucerna/photometric_file.h"
#include "lucerna/project.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/rays.h"
#include "lucerna/source_model.h"
#include "lucerna/trace.h"
#include "lucerna/trace_metrics.h"
#include "made.h"
#include "record.h"

/// What the classes of the module hold. All are immutable once made, so that threads may share them.
namespace lucerna::python {

namespace py = pybind11;

using Warnings = std::vector<std::string>;

/// lucerna.RaySet.
struct Rays {
  std::shared_ptr<const RaySet> set;
  Warnings warnings;
};

/// lucerna.SourceModel.
struct Model {
  std::shared_ptr<const SourceModel> model;
  Warnings warnings;
};

class Traced;

/// lucerna.IntensityDistribution: of a file, of arrays or of a trace.
struct Intensity {
  std::shared_ptr<const PhotometricFile> file;
  /// Standard errors of the values; empty where they are not known.
  std::vector<double> standard_error{};
  /// Of a trace: its flux, and where its other figures are: in the trace, or in a pickle.
  std::optional<Estimate> flux{};
  std::shared_ptr<const Traced> trace{};
  std::size_t far_field = 0;
  std::shared_ptr<const Kept> figures{};

  const IntensityDistribution& values() const { return file->distribution; }
};

/// lucerna.PlaneImage: of a trace or of a pickle.
struct Plane {
  /// What the counted rays say: all that does not depend on the figures. Of a pickle: everything.
  std::shared_ptr<const PlaneMetrics> counted;
  std::shared_ptr<const Traced> trace{};
  bool is_luminance = false;
  std::size_t index = 0;

  /// To be called without the interpreter's lock: takes seconds the first time.
  std::shared_ptr<const PlaneMetrics> figures() const;
};

/// lucerna.Reflector: a mirror, and the table that describes it.
struct Mirror {
  PlacedReflector placed;
  std::string toml;
};

/// lucerna.Scene.
struct SceneState {
  /// What it was made from: text, the name that messages call it and other names are relative to, and
  /// objects.
  std::string text;
  std::filesystem::path path;
  ProjectMemory memory;
  Project project;
};
using ScenePointer = std::shared_ptr<const SceneState>;
struct SceneHandle {
  ScenePointer state;
};

/// Reads the text of a scene.
SceneHandle read_scene(const std::string& text, const std::filesystem::path& path,
                       const ProjectMemory& memory, const py::object& callback = py::none());

/// Worked out once, when it is first asked for, whichever thread asks. To be asked without the interpreter's
/// lock.
template <class T>
class Lazy {
 public:
  explicit Lazy(std::shared_ptr<const T> value = nullptr) : value_(std::move(value)) {}

  template <class Make>
  std::shared_ptr<const T> get(const Make& make) const {
    const std::lock_guard lock(mutex_);
    if (!value_) value_ = std::make_shared<const T>(make());
    return value_;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const T> value_;
};

/// lucerna.TraceResult. Figures are worked out when they are first asked for, each kind by itself.
class Traced {
 public:
  using Figures = std::shared_ptr<const TraceMetrics>;

  /// `figures`: all of them, where they are there already.
  Traced(ScenePointer scene, NoiseTrace trace, const Figures& figures = nullptr);

  const ScenePointer& scene() const { return scene_; }
  const NoiseTrace& trace() const { return trace_; }
  const TraceResult& result() const { return trace_.result; }

  // To be called without the interpreter's lock.
  /// What the counted rays alone say: quick.
  Figures counted() const;
  /// The far fields with exact peaks, seconds each; the planes and images with backward light. The others of
  /// TraceMetrics are not in them.
  Figures far_fields() const;
  Figures images() const;
  /// All together: what the library's `trace_metrics` has.
  Figures all() const;

 private:
  ScenePointer scene_;
  NoiseTrace trace_;
  Lazy<TraceMetrics> counted_, far_fields_, images_, all_;
};
using TracedPointer = std::shared_ptr<Traced>;

/// lucerna.DesignResult: of `design`, or of a pickle, which has its figures and the files of its folder.
struct Designed {
  std::shared_ptr<const DesignedMirror> mirror;
  SceneHandle scene;
  TracedPointer traced;
  std::shared_ptr<const Kept> figures{}, files{};
};

/// lucerna.Objective.
struct ObjectiveHandle {
  std::shared_ptr<const Objective> objective;
  SceneHandle scene;
  ObjectiveOptions options;
};

// The classes and functions of each file.
void add_rays(py::module_& m);
void add_models(py::module_& m);
void add_intensity(py::module_& m);
void add_planes(py::module_& m);
void add_reflectors(py::module_& m);
void add_scenes(py::module_& m);
void add_traces(py::module_& m);
void add_designs(py::module_& m);
void add_objective(py::module_& m);
void add_comparison(py::module_& m);

/// "lm" or "W".
FluxUnit flux_unit(const std::string& symbol);
/// The flux that a caller gives in lm or in W; nothing if in neither.
struct GivenFlux {
  double flux;
  FluxUnit unit;
};
std::optional<GivenFlux> given_flux(std::optional<double> flux_lm, std::optional<double> flux_w);
/// The seed of random numbers, as an argument: InputError for a whole number that is none.
struct Seed {
  std::uint64_t value;
  // Stands for the number wherever the library wants it. NOLINTNEXTLINE(google-explicit-constructor)
  operator std::uint64_t() const { return value; }
};
/// A number of rays, which may be written as 1e6.
std::uint64_t ray_count(double rays);
/// What is quoted of a light distribution: with standard errors where it comes from rays.
py::object intensity_metrics(const Intensity& intensity);
py::object design_error(const DesignError& error);
py::object view_record(const ViewDifference& view);
/// By view: far, near, focus, beam, four_d.
py::object views_record(const RaySetComparison& views);

}  // namespace lucerna::python

template <>
class pybind11::detail::type_caster<lucerna::python::Seed> {
 public:
  PYBIND11_TYPE_CASTER(lucerna::python::Seed, const_name("int"));
  bool load(handle given, bool convert) {
    make_caster<std::uint64_t> number;
    if (number.load(given, convert)) {
      value = {cast_op<std::uint64_t>(number)};
      return true;
    }
    const auto whole = reinterpret_steal<object>(PyNumber_Index(given.ptr()));
    PyErr_Clear();
    if (!whole) return false;
    throw lucerna::InputError(
        "seed: found " + std::string(str(whole)) + ", expected a whole number from 0 to 2^64 - 1",
        lucerna::ErrorCause::out_of_range);
  }
};

// An object whose __init__ did not run holds nothing: TypeError instead of what pybind11 makes of it.
LUCERNA_PYTHON_CLASS(lucerna::python::Rays)
LUCERNA_PYTHON_CLASS(lucerna::python::Model)
LUCERNA_PYTHON_CLASS(lucerna::python::Intensity)
LUCERNA_PYTHON_CLASS(lucerna::python::Plane)
LUCERNA_PYTHON_CLASS(lucerna::python::Mirror)
LUCERNA_PYTHON_CLASS(lucerna::python::SceneHandle)
LUCERNA_PYTHON_CLASS(lucerna::python::Traced)
LUCERNA_PYTHON_CLASS(lucerna::python::Designed)
LUCERNA_PYTHON_CLASS(lucerna::python::ObjectiveHandle)
LUCERNA_PYTHON_HOLDER(lucerna::python::Traced)
