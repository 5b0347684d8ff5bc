// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl/filesystem.h>

#include <utility>

#include "call.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kSceneClassDoc = R"(Sources, mirrors, bodies and detectors: a project in memory.

A scene never changes, so threads may share it. It pickles with all objects that are in no file; files are
named, not copied.

Parameters
----------
sources : sequence
    SourceModel, RaySet, path_like, Source or mapping with the keys of a [[source]] table.
reflectors : sequence of Reflector or mapping
bodies : sequence of Body or mapping
detectors : sequence of Detector or mapping
    One far field where there is none.
target : IntensityDistribution, path_like or mapping, optional
    What a design is to reach, with the keys of [target].
design : mapping, optional
    How a design is found, with the keys of [design].

Raises
------
InputError
    place is the key, as 'reflector[0].focal_mm'.)";

constexpr const char* kLoadDoc = R"(load(path, *, callback=None)
--

Reads a project file.

Parameters
----------
path : path_like
callback : callable, optional
    Gets a Record with phase, done and total while ray files are read, ten times a second at most.

Returns
-------
Scene)";

constexpr const char* kFromTomlDoc = R"(from_toml(text, *, folder='.', memory={})
--

Reads a project from text.

Parameters
----------
text : str
folder : path_like
    What file names in it are relative to.
memory : mapping
    Objects that it names as files: SourceModel, RaySet or IntensityDistribution by name.

Returns
-------
Scene)";

constexpr const char* kToTomlDoc = R"(to_toml()
--

The scene as the text of a project file, with absolute file names.

Objects in memory are named as files that are not there: `memory` has them, and `save` writes them.

Returns
-------
str)";

constexpr const char* kSaveDoc = R"(save(path)
--

Writes a project file, and beside it what is in no file yet.

Parameters
----------
path : path_like)";

}  // namespace

namespace {

namespace fs = std::filesystem;

/// Objects by the names that a scene's text has for them.
ProjectMemory memory_of(const py::dict& objects) {
  ProjectMemory memory;
  for (const auto& [key, object] : objects) {
    if (!py::isinstance<py::str>(key)) throw py::type_error("memory: expected names that are text");
    const auto name = key.cast<std::string>();
    if (py::isinstance<Model>(object)) {
      memory.models[name] = object.cast<const Model&>().model;
    } else if (py::isinstance<Rays>(object)) {
      memory.rays[name] = object.cast<const Rays&>().set;
    } else if (py::isinstance<Intensity>(object)) {
      const auto& file = object.cast<const Intensity&>().file;
      memory.targets[name] = {file, &file->distribution};
    } else {
      throw py::type_error("memory: expected a SourceModel, RaySet or IntensityDistribution as '" + name +
                           "'");
    }
  }
  return memory;
}

py::dict objects_of(const ProjectMemory& memory) {
  py::dict out;
  for (const auto& [name, model] : memory.models) out[py::str(name)] = Model{model, {}};
  for (const auto& [name, rays] : memory.rays) out[py::str(name)] = Rays{rays, {}};
  for (const auto& [name, target] : memory.targets) {
    auto file = std::make_shared<PhotometricFile>();
    file->distribution = *target;
    out[py::str(name)] = Intensity{file};
  }
  return out;
}

SceneHandle make_scene(const py::object& sources, const py::object& reflectors, const py::object& bodies,
                       const py::object& detectors, const py::object& target, const py::object& design) {
  const py::tuple made =
      python_name("lucerna._toml", "scene_text")(sources, reflectors, bodies, detectors, target, design);
  return read_scene(made[0].cast<std::string>(), fs::current_path() / "scene",
                    memory_of(made[1].cast<py::dict>()));
}

SceneHandle load_scene(const fs::path& path, const py::object& callback) {
  return watched(callback, OnInterrupt::raise, [&](Watch& watch) {
    auto state = std::make_shared<SceneState>();
    state->project = read_project(path, watch);
    // With absolute names, so that it reads the same from any folder.
    state->text = project_text(state->project);
    state->path = fs::absolute(path);
    return SceneHandle{state};
  });
}

void save_scene(const SceneHandle& scene, const fs::path& path) {
  const std::string text = released(
      [&] { return project_text(save_memory(scene.state->project, fs::absolute(path).parent_path())); });
  python_name("lucerna._types", "write_whole")(path, py::bytes(text));
}

std::vector<std::string> detector_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& d : scene.far_fields) names.push_back(d.name);
  for (const auto& d : scene.planes) names.push_back(d.name);
  for (const auto& d : scene.luminances) names.push_back(d.name);
  for (const auto& d : scene.ray_detectors) names.push_back(d.name);
  return names;
}

void add_facts(py::class_<SceneHandle>& c) {
  c.def_property_readonly(
      "flux", [](const SceneHandle& s) { return total_flux(s.state->project.scene.sources); },
      "Flux of all sources together, in `unit`.");
  c.def_property_readonly(
      "unit",
      [](const SceneHandle& s) {
        return std::string(symbol(s.state->project.scene.sources.front().rays->flux_unit()));
      },
      "Unit of the sources' flux: 'lm' or 'W'.");
  c.def_property_readonly(
      "detectors", [](const SceneHandle& s) { return detector_names(s.state->project.scene); },
      "Names of the detectors.");
  c.def_property_readonly(
      "inputs", [](const SceneHandle& s) { return s.state->project.inputs; },
      "Files that the scene depends on.");
  c.def_property_readonly(
      "warnings", [](const SceneHandle& s) { return s.state->project.warnings; },
      "What was odd about the files but could be read, one sentence each.");
  c.def_property_readonly(
      "memory", [](const SceneHandle& s) { return objects_of(s.state->project.memory); },
      "Models, ray sets and targets that are in no file, by the names that `to_toml` has for them.");
  c.def_property_readonly(
      "default_rays", [](const SceneHandle& s) { return default_ray_count(s.state->project.scene); },
      "Rays that are traced where neither a number nor a noise is asked for.");
}

}  // namespace

SceneHandle read_scene(const std::string& text, const fs::path& path, const ProjectMemory& memory,
                       const py::object& callback) {
  return watched(callback, OnInterrupt::raise, [&](Watch& watch) {
    auto state = std::make_shared<SceneState>();
    state->project = parse_project(text, path, memory, watch);
    state->text = text;
    state->path = path;
    state->memory = memory;
    return SceneHandle{state};
  });
}

void add_scenes(py::module_& m) {
  auto c = py::class_<SceneHandle>(m, "Scene", kSceneClassDoc);
  c.def(
      py::init(&make_scene), "sources"_a, py::kw_only(), "reflectors"_a = py::tuple(),
      "bodies"_a = py::tuple(), "detectors"_a = py::tuple(), "target"_a = py::none(), "design"_a = py::none(),
      "__init__(self, sources, *, reflectors=(), bodies=(), detectors=(), target=None, design=None)\n--\n\n");
  c.def_static("load", &load_scene, "path"_a, py::kw_only(), "callback"_a = py::none(), kLoadDoc);
  c.def_static(
      "from_toml",
      [](const std::string& text, const fs::path& folder, const py::object& memory) {
        return read_scene(text, fs::absolute(folder) / "scene", memory_of(mapping(memory, "memory")));
      },
      "text"_a, py::kw_only(), "folder"_a = fs::path("."), "memory"_a = py::dict(), kFromTomlDoc);
  c.def(
      "to_toml", [](const SceneHandle& s) { return project_text(s.state->project); }, kToTomlDoc);
  c.def("save", &save_scene, "path"_a, kSaveDoc);
  add_facts(c);
  c.def(
      "__eq__",
      [](const SceneHandle& a, const SceneHandle& b) {
        return a.state == b.state || (project_text(a.state->project) == project_text(b.state->project) &&
                                      objects_of(a.state->memory).equal(objects_of(b.state->memory)));
      },
      py::is_operator());
  c.attr("__hash__") = py::none();
  c.def(py::pickle(
      [](const SceneHandle& s) {
        return py::make_tuple(s.state->text, s.state->path, objects_of(s.state->memory));
      },
      [](const py::tuple& state) {
        if (state.size() != 3)
          throw InputError("a pickle of another version of lucerna", ErrorCause::damaged);
        return read_scene(state[0].cast<std::string>(), state[1].cast<fs::path>(),
                          memory_of(state[2].cast<py::dict>()));
      }));
}

}  // namespace lucerna::python
