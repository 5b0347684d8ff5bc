// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "call.h"
#include "lucerna/report.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kDesignResultClassDoc =
    R"(A designed mirror or lens, its light, and how far that is from the target.

A result never changes, so threads may share it. It pickles with all its figures and the files that `save`
writes.)";

constexpr const char* kSaveDoc = R"(save(folder)
--

Writes what `lucerna design` leaves in a folder.

That is the mirror or lens as TOML, STEP, STL, OBJ, DXF and CSV, its light, history, checkpoint and result.json.

Parameters
----------
folder : path_like
    Made if it is missing; files of the same names are replaced.

Returns
-------
list of str
    Names of the files.)";

}  // namespace

namespace {

namespace fs = std::filesystem;

py::object box_error(const BoxErrorEstimate& e) {
  py::dict out;
  out["value"] = e.value;
  out["floor"] = e.floor;
  out["excess"] = estimate(Estimate{e.excess, e.standard_error});
  return record(out);
}

py::object zone_record(const ZoneCheck& zone) {
  py::dict out;
  out["name"] = zone.name;
  out["cells"] = zone.cells;
  out["unit"] = zone.on_plane ? "lx" : "cd";
  out["min"] = estimate(zone.min);
  out["max"] = estimate(zone.max);
  out["mean"] = estimate(zone.mean);
  out["verdict"] = std::string(to_string(zone.verdict()));
  py::list bounds;
  for (const ZoneBoundCheck& b : zone.bounds) {
    py::dict bound;
    bound["key"] = b.key;
    bound["allowed"] = b.allowed;
    bound["found"] = estimate(b.found);
    bound["reference"] = b.reference;
    bound["missing"] = b.missing;
    bound["place"] = b.place;
    bound["verdict"] = std::string(to_string(b.verdict));
    if (b.direct) bound["direct"] = estimate(*b.direct);
    bound["broken_by_direct"] = b.broken_by_direct;
    bounds.append(record(bound));
  }
  out["bounds"] = bounds;
  return record(out);
}

py::object limit_record(const LimitCheck& limit) {
  py::dict out;
  out["limit"] = limit.limit;
  out["allowed"] = limit.allowed;
  out["found"] = estimate(limit.found);
  out["held"] = limit.held;
  return record(out);
}

py::object bound_record(const DesignBound& b) {
  py::dict out;
  out["error"] = b.error;
  out["etendue_error"] = b.etendue_error;
  out["direct_error"] = b.direct_error;
  out["target_share"] = b.target_share;
  out["max_share"] = b.max_share;
  out["etendue_mm2sr"] = b.etendue_mm2sr;
  return record(out);
}

py::object pareto_record(const ParetoPoint& p) {
  py::dict out;
  out["light_weight"] = p.light_weight;
  out["vertex_mm"] = p.vertex_mm;
  out["error"] = design_error(p.error);
  return record(out);
}

py::object advice_record(const AdviceTrial& a) {
  py::dict out;
  out["change"] = a.change;
  out["error"] = design_error(a.error);
  out["helps"] = a.helps;
  return record(out);
}

py::object lens_record(const Solid& lens) {
  const auto mesh = surface_mesh(lens);
  std::vector<double> outline_mm;
  for (const auto& corner : lens.outline_mm)
    outline_mm.insert(outline_mm.end(), corner.begin(), corner.end());
  std::vector<std::int64_t> triangles;
  for (const auto& t : mesh->triangles) triangles.insert(triangles.end(), t.begin(), t.end());
  py::dict out;
  out["name"] = lens.name;
  out["refractive_index"] = lens.refractive_index;
  out["absorption_per_mm"] = lens.absorption_per_mm;
  out["position_mm"] = vector(lens.world_from_solid.origin_mm());
  out["x_axis"] = vector(lens.world_from_solid.ex());
  out["axis"] = vector(lens.world_from_solid.ez());
  out["has_face"] = lens.face != nullptr;
  out["has_bottom_face"] = lens.bottom_face != nullptr;
  out["outline_mm"] = owned(std::move(outline_mm), grid(lens.outline_mm.size(), 2));
  out["vertices_mm"] = owned(mesh->vertices_mm);
  out["triangles"] = owned(std::move(triangles), grid(mesh->triangles.size(), 3));
  return record(out);
}

py::object spread_record(const ToleranceSpread& s) {
  py::dict out;
  out["figure"] = s.figure;
  out["nominal"] = estimate(s.nominal);
  out["mean"] = estimate(s.mean);
  out["standard_deviation"] = estimate(s.standard_deviation);
  out["min"] = estimate(s.min);
  out["max"] = estimate(s.max);
  out["cases"] = s.cases;
  return record(out);
}

template <class Item, class Make>
py::list list_of(const std::vector<Item>& items, const Make& make) {
  py::list out;
  for (const Item& item : items) out.append(make(item));
  return out;
}

py::object history(const DesignedMirror& d) {
  const std::vector<DesignStep>& steps = d.history;
  const auto column = [&](auto member) {
    using T = std::remove_cvref_t<decltype(steps.front().*member)>;
    std::vector<std::conditional_t<std::is_same_v<T, bool>, std::uint8_t, T>> values;
    for (const DesignStep& s : steps) values.push_back(s.*member);
    return owned(std::move(values));
  };
  py::dict out;
  out["evaluations"] = column(&DesignStep::evaluations);
  out["rays"] = column(&DesignStep::rays);
  out["relative_rms"] = column(&DesignStep::relative_rms);
  out["floor"] = column(&DesignStep::floor);
  out["efficiency"] = column(&DesignStep::efficiency);
  out["in_rectangle"] = column(&DesignStep::in_rectangle);
  out["accepted"] = column(&DesignStep::accepted).attr("astype")("bool");
  return record(out);
}

/// What a callback gets of a step besides its phase.
void note_step(const DesignStep& step, Watch& watch) {
  watch.note([step](py::dict& out) {
    out["evaluations"] = step.evaluations;
    out["rays"] = step.rays;
    out["relative_rms"] = step.relative_rms;
    out["floor"] = step.floor;
    out["efficiency"] = step.efficiency;
    out["in_rectangle"] = step.in_rectangle;
  });
}

Designed run_design(const SceneHandle& scene, const DesignSettings& settings, const py::object& callback) {
  return watched(callback, OnInterrupt::keep, [&](Watch& watch) {
    const SceneState& given = *scene.state;
    auto mirror = std::make_shared<DesignedMirror>(
        design(given.project, given.path.string(), settings, watch,
               [&](const DesignStep& step, const std::string&) { note_step(step, watch); }));
    auto state = std::make_shared<SceneState>();
    state->text = mirror->project_text;
    state->path = given.path;
    state->memory = given.memory;
    state->project = parse_project(state->text, state->path, state->memory);
    Designed out{mirror, {state}, nullptr};
    out.traced = std::make_shared<Traced>(state, NoiseTrace{mirror->traced, std::nan(""), NoiseEnd::time},
                                          std::shared_ptr<const TraceMetrics>(mirror, &mirror->light));
    return out;
  });
}

Designed design_scene(const SceneHandle& scene, Seed seed, std::optional<double> time_s, double max_rays,
                      const std::string& device, bool tolerances, bool pareto, bool advise,
                      const py::bytes& checkpoint, const py::object& callback) {
  DesignSettings settings;
  settings.seed = seed;
  if (time_s && !(*time_s > 0.0))
    throw InputError("time_s: found " + std::to_string(*time_s) + ", expected a number above 0",
                     ErrorCause::out_of_range);
  settings.time_s = time_s;
  settings.max_rays = ray_count(max_rays);
  settings.device = trace_device(device);
  settings.tolerances = tolerances;
  settings.pareto = pareto;
  settings.advise = advise;
  settings.checkpoint = checkpoint;
  return run_design(scene, settings, callback);
}

/// A property of a design that a pickle keeps as it is.
struct Finding {
  const char* name;
  py::object (*get)(const DesignedMirror&);
  const char* doc;
};

const Finding kFindings[] = {
    {"error", [](const DesignedMirror& d) { return design_error(d.error); },
     "Error against the target, by fresh rays through the exported mesh, as a Record."},
    {"start_error", [](const DesignedMirror& d) { return design_error(d.start_error); },
     "The same of what the search began with: the given mirror, or where limits exclude it one within them."},
    {"relative_rms",
     [](const DesignedMirror& d) {
       return estimate(Estimate{d.error.c48.excess, d.error.c48.standard_error});
     },
     "The headline: relative error in 48 x 48 boxes with the noise taken out, an Estimate."},
    {"floor", [](const DesignedMirror& d) { return py::object(py::cast(d.error.c48.floor)); },
     "What the noise alone makes of the error in 48 x 48 boxes."},
    {"efficiency", [](const DesignedMirror& d) { return estimate(d.efficiency); },
     "Share of the sources' flux that leaves the luminaire."},
    {"end", [](const DesignedMirror& d) { return py::object(py::cast(std::string(to_string(d.end)))); },
     "Why it ended: 'converged', 'time' or 'interrupted'."},
    {"interrupted",
     [](const DesignedMirror& d) { return py::object(py::cast(d.end == DesignTermination::interrupted)); },
     "True if Ctrl-C stopped it; the mirror is then the best so far."},
    {"zones", [](const DesignedMirror& d) { return py::object(list_of(d.zones, &zone_record)); },
     "The target's zones in the light of the result, as Records."},
    {"limits", [](const DesignedMirror& d) { return py::object(list_of(d.limits, &limit_record)); },
     "Every limit as found in the exported mesh and its light, as Records."},
    {"bound", [](const DesignedMirror& d) { return bound_record(d.bound); },
     "What no mirror of this aperture and height can be better than, as a Record."},
    {"remarks", [](const DesignedMirror& d) { return py::object(py::cast(d.remarks)); },
     "What is known of why the error is not smaller, one sentence each."},
    {"pareto", [](const DesignedMirror& d) { return py::object(list_of(d.pareto, &pareto_record)); },
     "The trade between error and light, if it was asked for."},
    {"advice", [](const DesignedMirror& d) { return py::object(list_of(d.advice, &advice_record)); },
     "What other outlines and families would bring, if it was asked for."},
    {"tolerances",
     [](const DesignedMirror& d) {
       return d.tolerances ? py::object(list_of(d.tolerances->spread, &spread_record))
                           : py::object(py::none());
     },
     "How figures vary over inexact luminaires, as Records, if it was asked for."},
    {"lens", [](const DesignedMirror& d) { return d.lens ? lens_record(*d.lens) : py::object(py::none()); },
     "The lens that was shaped, as a Record: its outline, its surface as triangles in its own frame, its "
     "medium; None for a mirror."},
    {"evaluations", [](const DesignedMirror& d) { return py::object(py::cast(d.evaluations)); },
     "Evaluations of the objective."},
    {"rays", [](const DesignedMirror& d) { return py::object(py::cast(d.rays)); },
     "Rays of all evaluations."},
    {"checkpoint", [](const DesignedMirror& d) { return py::object(py::bytes(d.checkpoint)); },
     "The state that `design(resume=...)` goes on from."},
    {"history", &history, "Every step, as a Record of arrays."},
};

py::object finding(const Designed& d, const Finding& f) {
  return d.mirror ? f.get(*d.mirror) : d.figures->get()[f.name];
}

void add_findings(py::class_<Designed>& c) {
  for (const Finding& f : kFindings)
    c.def_property_readonly(
        f.name, [&f](const Designed& d) { return finding(d, f); }, f.doc);
}

py::list save(const Designed& d, const fs::path& folder) {
  if (d.mirror) return py::cast(released([&] { return write_design(folder, *d.mirror); }));
  const auto kept = d.files->get().cast<py::tuple>();
  python_name("lucerna._types", "write_folder")(folder, kept[1]);
  return kept[0];
}

/// Every finding, the light, and the files that `save` writes.
py::tuple state(const py::object& self) {
  const auto& d = self.cast<const Designed&>();
  py::dict figures;
  for (const Finding& f : kFindings) figures[f.name] = finding(d, f);
  return py::make_tuple(figures, d.scene, d.traced,
                        python_name("lucerna._types", "read_folder")(self.attr("save")));
}

Designed from_state(const py::tuple& s) {
  if (s.size() != 4) throw InputError("a pickle of another version of lucerna", ErrorCause::damaged);
  const auto figures = s[0].cast<py::dict>();
  for (const Finding& f : kFindings) {
    if (!figures.contains(f.name)) throw InputError("a damaged pickle of a design", ErrorCause::damaged);
  }
  return {nullptr, s[1].cast<SceneHandle>(), s[2].cast<TracedPointer>(),
          std::make_shared<const Kept>(figures), std::make_shared<const Kept>(s[3].cast<py::tuple>())};
}

}  // namespace

py::object design_error(const DesignError& e) {
  py::dict out;
  out["c12"] = box_error(e.c12);
  out["c24"] = box_error(e.c24);
  out["c48"] = box_error(e.c48);
  out["scale"] = e.scale;
  out["in_rectangle"] = estimate(e.in_rectangle);
  out["outside_share"] = estimate(e.outside_share);
  out["outside_direct"] = estimate(e.outside_direct);
  out["outside"] = box_error(e.outside);
  out["worst_cell"] = estimate(e.worst_cell);
  out["rays"] = e.rays;
  return record(out);
}

void add_designs(py::module_& m) {
  auto c = py::class_<Designed>(m, "DesignResult", kDesignResultClassDoc);
  add_findings(c);
  c.def_property_readonly(
      "scene", [](const Designed& d) { return d.scene; },
      "The project with the mirror or lens that was found.");
  c.def_property_readonly(
      "traced", [](const Designed& d) { return d.traced; }, "The light of that project, a TraceResult.");
  c.def("save", &save, "folder"_a, kSaveDoc);
  c.def(py::pickle(&state, &from_state));
  m.def("_design", &design_scene, "scene"_a, py::kw_only(), "seed"_a, "time_s"_a, "max_rays"_a, "device"_a,
        "tolerances"_a, "pareto"_a, "advise"_a, "checkpoint"_a, "callback"_a);
}

}  // namespace lucerna::python
