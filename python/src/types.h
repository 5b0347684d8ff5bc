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
#include "lucerna/rays.h"
#include "lucerna/source_model.h"
#include "lucerna/trace.h"
#include "lucerna/trace_metrics.h"

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

/// lucerna.IntensityDistribution: of a file, of arrays or of a trace.
struct Intensity {
  std::shared_ptr<const PhotometricFile> file;
  /// Standard errors of the values; empty where they are not known.
  std::vector<double> standard_error;
  /// Of a trace.
  std::shared_ptr<const FarFieldMetrics> traced;

  const IntensityDistribution& values() const { return file->distribution; }
};

/// lucerna.PlaneImage.
struct Plane {
  std::shared_ptr<const PlaneMetrics> metrics;
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

/// lucerna.TraceResult. Figures are worked out when they are first asked for.
class Traced {
 public:
  Traced(ScenePointer scene, NoiseTrace trace) : scene_(std::move(scene)), trace_(std::move(trace)) {}
  /// With figures that are there already.
  Traced(ScenePointer scene, NoiseTrace trace, TraceMetrics metrics);

  const ScenePointer& scene() const { return scene_; }
  const NoiseTrace& trace() const { return trace_; }
  const TraceResult& result() const { return trace_.result; }
  /// To be called without the interpreter's lock: takes seconds the first time.
  std::shared_ptr<const TraceMetrics> metrics() const;

 private:
  ScenePointer scene_;
  NoiseTrace trace_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const TraceMetrics> metrics_;
};

/// lucerna.DesignResult.
struct Designed {
  std::shared_ptr<const DesignedMirror> mirror;
  SceneHandle scene;
  std::shared_ptr<Traced> traced;
};

/// lucerna.Objective.
struct ObjectiveHandle {
  std::shared_ptr<const Objective> objective;
  ScenePointer scene;
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
/// A number of rays, which may be written as 1e6.
std::uint64_t ray_count(double rays);
/// What is quoted of a light distribution: with standard errors where it comes from rays.
py::object intensity_metrics(const Intensity& intensity);
py::object design_error(const DesignError& error);

}  // namespace lucerna::python
