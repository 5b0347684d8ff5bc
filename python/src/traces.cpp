// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>

#include "call.h"
#include "lucerna/report.h"
#include "lucerna/trace_file.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kTraceDoc =
    R"(trace(*, rays=None, noise=0.01, time_s=60.0, seed=1, sequence='sobol', max_bounces=100,
    device='auto', isa='', resume=None, callback=None)
--

Traces light from the sources through the mirrors into the detectors.

Parameters
----------
rays : int or (int, int), optional
    How many, or a range of ray numbers; 1e7 is taken, too. Where it is not given, rays are traced until the
    far fields have the noise asked for.
noise : float
    Largest standard error of an intensity above 1 % of the peak, over the peak.
time_s : float
    Seconds after which to stop with the noise that is left.
seed : int
    Of the random numbers: the same bits for the same seed, on any number of threads.
sequence : str
    'sobol' (evenly spread) or 'random' (independent).
max_bounces : int
    Reflections after which a ray is given up and counted as lost.
device : str
    'cpu', 'cuda' or 'auto'.
isa : str
    Instruction set: 'scalar', 'portable', 'avx2' or 'avx512'; the best where it is empty.
resume : TraceResult, optional
    A trace of the same scene to go on with.
callback : callable, optional
    Gets a Record with phase, done and total (rays), ten times a second at most.

Returns
-------
TraceResult
    After Ctrl-C what was whole, with `interrupted` true.

Raises
------
InputError
    On a scene that cannot be traced.
KeyboardInterrupt
    On Ctrl-C where nothing was whole.)";

constexpr const char* kMergeDoc = R"(merge(parts)
--

Adds traces of ranges of rays of one scene: to the bit what one trace of all rays is.

Parameters
----------
parts : sequence of TraceResult
    In any order; their ranges meet end to end.

Returns
-------
TraceResult

Raises
------
InputError
    Where they are of different scenes, seeds or instruction sets, or rays are missing or double.)";

constexpr const char* kReadTraceDoc = R"(read_trace(folder)
--

Reads the folder of a trace, of the program's or of `TraceResult.save`.

Parameters
----------
folder : path_like

Returns
-------
TraceResult)";

constexpr const char* kTraceResultClassDoc = R"(Where the light went.

`result[name]` is what a detector recorded: an IntensityDistribution, a PlaneImage or a RaySet. Counts and
the arrays of far fields are there at once. Figures are worked out when they are first asked for, by any of
`metrics`, `summary`, `save` or `report`: the exact peak of a far field takes seconds. A result never changes,
so threads may share it. It pickles as the raw sums, which `merge` adds.)";

constexpr const char* kSummaryDoc = R"(summary()
--

A short table of the figures.

Returns
-------
list of str)";

constexpr const char* kSaveDoc = R"(save(folder)
--

Writes what `lucerna trace` leaves in a folder.

That is result.json, project.toml, the raw sums, and the files of each detector.

Parameters
----------
folder : path_like
    Made if it is missing; files of the same names are replaced.

Returns
-------
list of str
    What a ray format had to leave out.)";

}  // namespace

Traced::Traced(ScenePointer scene, NoiseTrace trace, const Figures& figures)
    : scene_(std::move(scene)),
      trace_(std::move(trace)),
      counted_(figures),
      far_fields_(figures),
      images_(figures),
      all_(figures) {}

Traced::Figures Traced::counted() const {
  return counted_.get([&] { return trace_metrics(result()); });
}

Traced::Figures Traced::far_fields() const {
  return far_fields_.get([&] { return trace_metrics(result(), scene_->project.scene, {.images = false}); });
}

Traced::Figures Traced::images() const {
  return images_.get([&] { return trace_metrics(result(), scene_->project.scene, {.far_fields = false}); });
}

Traced::Figures Traced::all() const {
  return all_.get([&] {
    TraceMetrics figures = *counted();
    figures.far_fields = far_fields()->far_fields;
    figures.planes = images()->planes;
    figures.luminances = images()->luminances;
    return figures;
  });
}

namespace {

namespace fs = std::filesystem;
/// A number of rays, or a pair of ray numbers.
void set_rays(const py::object& rays, TraceOptions& options) {
  const auto is = [&](PyTypeObject& type) { return PyObject_TypeCheck(rays.ptr(), &type) != 0; };
  const bool is_text = is(PyUnicode_Type) || is(PyBytes_Type) || is(PyByteArray_Type);
  const bool is_number = py::isinstance<py::array>(rays) && rays.cast<py::array>().ndim() == 0;
  if (py::isinstance<py::sequence>(rays) && !is_text && !is_number) {
    const auto range = rays.cast<py::sequence>();
    if (range.size() != 2)
      throw InputError("rays: found " + std::to_string(range.size()) + " numbers, expected (first, last)");
    options.first_ray = ray_count(range[0].cast<double>());
    options.last_ray = ray_count(range[1].cast<double>());
  } else {
    options.last_ray = ray_count(rays.cast<double>());
  }
}

double positive(const char* name, double value) {
  if (value > 0.0) return value;
  throw InputError(std::string(name) + ": found " + std::to_string(value) + ", expected a number above 0",
                   ErrorCause::out_of_range);
}

/// InputError with `message` where the projects differ.
void check_same_scene(const ScenePointer& a, const ScenePointer& b, const char* message) {
  if (a != b && project_text(a->project) != project_text(b->project))
    throw InputError(message, ErrorCause::mismatch);
}

TracedPointer trace_scene(const SceneHandle& scene, const py::object& rays, double noise, double time_s,
                          Seed seed, const std::string& sequence, int max_bounces, const std::string& device,
                          const std::string& isa, const std::optional<TracedPointer>& resume,
                          const py::object& callback) {
  TraceOptions options;
  options.seed = seed;
  options.sequence = sequence_kind(sequence);
  options.max_bounces = max_bounces;
  options.device = trace_device(device);
  options.isa = isa;
  NoiseGoal goal;
  goal.noise = positive("noise", noise);
  goal.max_seconds = positive("time_s", time_s);
  if (!rays.is_none()) set_rays(rays, options);
  std::optional<TraceResult> from;
  if (resume) {
    check_same_scene(scene.state, (*resume)->scene(), "the trace cannot be resumed: it is of another scene");
    from = (*resume)->result();
  }
  return watched(callback, OnInterrupt::keep, [&](Watch& watch) -> TracedPointer {
    const Scene& s = scene.state->project.scene;
    return std::make_shared<Traced>(scene.state, rays.is_none()
                                                     ? trace_until(s, options, goal, std::move(from), watch)
                                                     : trace_rays(s, options, std::move(from), watch));
  });
}

TracedPointer merge_traces(const std::vector<TracedPointer>& parts) {
  if (parts.empty()) throw InputError("found no traces to merge, expected at least one");
  return released([&]() -> TracedPointer {
    std::vector<TracedPointer> ordered = parts;
    std::stable_sort(ordered.begin(), ordered.end(), [](const TracedPointer& a, const TracedPointer& b) {
      return a->result().first_ray < b->result().first_ray;
    });
    TraceResult sum = ordered.front()->result();
    for (std::size_t i = 1; i < ordered.size(); ++i) {
      check_same_scene(ordered[i]->scene(), ordered.front()->scene(),
                       "the traces cannot be added: they are of different scenes");
      sum = merge(sum, ordered[i]->result());
    }
    return std::make_shared<Traced>(ordered.front()->scene(),
                                    NoiseTrace{std::move(sum), std::nan(""), NoiseEnd::rays});
  });
}

py::dict causes(const std::vector<std::pair<std::string, Estimate>>& all) {
  py::dict out;
  for (const auto& [name, value] : all) out[py::str(name)] = estimate(value);
  return out;
}

py::object ledger_record(const Traced& t) {
  const Ledger l = ledger(t.result());
  py::dict out;
  out["unit"] = std::string(symbol(l.unit));
  out["emitted"] = l.emitted;
  out["out_direct"] = estimate(l.out_direct);
  out["out_reflected"] = estimate(l.out_reflected);
  out["absorbed"] = record(causes(l.absorbed));
  out["lost"] = record(causes(l.lost));
  out["all_lost"] = estimate(l.all_lost);
  out["lost_rays"] = l.lost_rays;
  out["rays"] = l.rays;
  out["reflections_per_ray"] = estimate(l.reflections_per_ray);
  return record(out);
}

/// The rays that left, as a set of their own.
Rays out_rays(const Traced& t) {
  return released([&] {
    const Ledger l = ledger(t.result());
    auto set = std::make_shared<RaySet>();
    set->header.flux_unit = l.unit;
    set->header.set_flux(l.out_direct.mean + l.out_reflected.mean);
    set->rays = t.result().out_rays;
    return Rays{set, {}};
  });
}

py::object detector(const TracedPointer& t, const std::string& name) {
  const TraceResult& r = t->result();
  for (const RayDetector& d : r.ray_detectors) {
    if (d.name == name) return py::cast(out_rays(*t));
  }
  const auto known = [&](const auto& list) {
    return std::any_of(list.begin(), list.end(), [&](const auto& d) { return d.name == name; });
  };
  if (!known(r.far_fields) && !known(r.planes) && !known(r.luminances))
    throw py::key_error("no detector is named '" + name + "'");
  const Traced::Figures counted = released([&] { return t->counted(); });
  for (std::size_t i = 0; i < counted->far_fields.size(); ++i) {
    const FarFieldResult& f = counted->far_fields[i];
    if (f.field.name != name) continue;
    auto file = std::make_shared<PhotometricFile>();
    file->distribution = f.intensity.distribution;
    file->luminaire.generation_type = kGenerationSimulated;
    return py::cast(Intensity{file, f.intensity.standard_error_cd, f.metrics.flux, t, i});
  }
  for (const auto* images : {&counted->planes, &counted->luminances}) {
    for (std::size_t i = 0; i < images->size(); ++i) {
      const PlaneMetrics& p = (*images)[i];
      if (p.image.name == name) return py::cast(Plane{{counted, &p}, t, images == &counted->luminances, i});
    }
  }
  throw py::key_error("no detector is named '" + name + "'");
}

std::vector<std::string> names_of(const Traced& t) {
  const TraceResult& r = t.result();
  std::vector<std::string> names;
  for (const auto& d : r.far_fields) names.push_back(d.name);
  for (const auto& d : r.planes) names.push_back(d.name);
  for (const auto& d : r.luminances) names.push_back(d.name);
  for (const auto& d : r.ray_detectors) names.push_back(d.name);
  return names;
}

std::string end_name(NoiseEnd end) {
  switch (end) {
    case NoiseEnd::reached:
      return "reached";
    case NoiseEnd::time:
      return "time";
    case NoiseEnd::rays:
      return "rays";
    case NoiseEnd::finite_source:
      return "finite_source";
    case NoiseEnd::no_goal:
      return "no_goal";
    case NoiseEnd::interrupted:
      return "interrupted";
  }
  return "";
}

std::vector<std::string> summary(const Traced& t) {
  return released([&] { return trace_summary(*t.all()); });
}

Warnings save_trace(const Traced& t, const fs::path& folder) {
  return released([&] {
    Warnings warnings;
    write_trace(folder, t.scene()->project, t.result(), *t.all(), &warnings);
    return warnings;
  });
}

void add_facts(py::class_<Traced, std::shared_ptr<Traced>>& c) {
  const auto fact = [&](const char* name, auto get, const char* doc) {
    c.def_property_readonly(
        name, [get](const Traced& t) { return get(t); }, doc);
  };
  fact("detectors", &names_of, "Names of the detectors, the keys of the result.");
  fact(
      "scene", [](const Traced& t) { return SceneHandle{t.scene()}; }, "The scene that was traced.");
  fact(
      "rays", [](const Traced& t) { return py::make_tuple(t.result().first_ray, t.result().last_ray); },
      "Numbers of the rays: the first, and one past the last.");
  fact(
      "seed", [](const Traced& t) { return t.result().seed; }, "Of the random numbers.");
  fact(
      "sequence", [](const Traced& t) { return std::string(to_string(t.result().sequence)); },
      "'sobol' or 'random'.");
  fact(
      "isa", [](const Traced& t) { return t.result().isa; },
      "Tracer and instruction set; only equal ones can be merged.");
  fact(
      "noise", [](const Traced& t) { return t.trace().noise; },
      "Largest standard error of an intensity above 1 % of the peak, over the peak; not a number where it is "
      "not "
      "known.");
  fact(
      "end", [](const Traced& t) { return end_name(t.trace().end); },
      "Why it stopped: 'reached', 'time', 'rays', 'finite_source', 'no_goal' or 'interrupted'.");
  fact(
      "interrupted", [](const Traced& t) { return t.trace().end == NoiseEnd::interrupted; },
      "True if Ctrl-C stopped it before its end.");
  fact(
      "ledger", &ledger_record,
      "Energy balance, as a Record of Estimates in the unit of the flux: emitted, out_direct, out_reflected, "
      "absorbed, lost.");
}

void add_trace_call(py::module_& m) {
  py::type::of<SceneHandle>().attr("trace") =
      py::cpp_function(&trace_scene, py::name("trace"), py::is_method(py::type::of<SceneHandle>()),
                       py::kw_only(), "rays"_a = py::none(), "noise"_a = 0.01, "time_s"_a = 60.0,
                       "seed"_a = 1, "sequence"_a = "sobol", "max_bounces"_a = 100, "device"_a = "auto",
                       "isa"_a = "", "resume"_a = py::none(), "callback"_a = py::none(), kTraceDoc);
  m.def("merge", &merge_traces, "parts"_a, kMergeDoc);
  m.def(
      "read_trace",
      [](const fs::path& folder) -> TracedPointer {
        return released([&]() -> TracedPointer {
          auto state = std::make_shared<SceneState>();
          state->path = fs::absolute(folder / "project.toml");
          TraceResult result = read_trace(folder);
          state->project = read_project(state->path);
          state->text = project_text(state->project);
          return std::make_shared<Traced>(state, NoiseTrace{std::move(result), std::nan(""), NoiseEnd::rays});
        });
      },
      "folder"_a, kReadTraceDoc);
}

}  // namespace

void add_traces(py::module_& m) {
  auto c = py::class_<Traced, std::shared_ptr<Traced>>(m, "TraceResult", kTraceResultClassDoc);
  add_facts(c);
  c.def(
      "__getitem__",
      [](const std::shared_ptr<Traced>& t, const std::string& name) { return detector(t, name); }, "name"_a);
  c.def("__len__", [](const Traced& t) { return names_of(t).size(); });
  c.def("__iter__", [](const Traced& t) { return py::iter(py::cast(names_of(t))); });
  c.def("summary", &summary, kSummaryDoc);
  c.def("save", &save_trace, "folder"_a, kSaveDoc);
  c.def(
      "__eq__", [](const Traced& a, const Traced& b) { return a.result() == b.result(); }, py::is_operator());
  c.attr("__hash__") = py::none();
  c.def(py::pickle(
      [](const Traced& t) {
        return py::make_tuple(py::bytes(trace_bytes(t.result())), SceneHandle{t.scene()}, t.trace().noise,
                              static_cast<int>(t.trace().end));
      },
      [](const py::tuple& s) {
        if (s.size() != 4) throw InputError("a pickle of another version of lucerna", ErrorCause::damaged);
        const auto end = static_cast<NoiseEnd>(s[3].cast<int>());
        if (end_name(end).empty()) throw InputError("a damaged pickle of a trace", ErrorCause::damaged);
        return std::make_shared<Traced>(
            s[1].cast<SceneHandle>().state,
            NoiseTrace{trace_from_bytes(s[0].cast<std::string>(), "pickle"), s[2].cast<double>(), end});
      }));
  add_trace_call(m);
}

}  // namespace lucerna::python
