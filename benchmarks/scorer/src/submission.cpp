// SPDX-License-Identifier: Apache-2.0
#include "submission.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "light_table.h"

namespace bench {

namespace {

/// Files are named from the folder of the submission, and stay in it, also where links lead.
std::string beside(const JsonNode& name) {
  namespace fs = std::filesystem;
  const fs::path given = name.text(), folder = fs::path(name.file()).parent_path(), file = folder / given;
  std::error_code none;
  // Of what is not there, only an absolute path has a canonical one.
  const fs::path home = fs::weakly_canonical(fs::absolute(folder.empty() ? "." : folder), none);
  const fs::path real = fs::weakly_canonical(fs::absolute(file), none);
  const bool within = std::mismatch(home.begin(), home.end(), real.begin(), real.end()).first == home.end();
  if (given.empty() || given.is_absolute() || !within) name.fail("a file in the folder of the submission");
  if (fs::exists(file, none) && !fs::is_regular_file(file, none))
    throw InputError(file.string(), "file", "a folder or a device", "a file");
  return file.string();
}

/// One, or the faces of a STEP file.
std::vector<std::shared_ptr<const Surface>> read_surfaces(const JsonNode& s) {
  const Frame place = s.has("place") ? s.at("place").frame() : Frame();
  if (s.has("stl") + s.has("bspline") + s.has("step") != 1) s.fail("one of the keys stl, step and bspline");
  if (s.has("step")) {
    std::vector<std::shared_ptr<const Surface>> faces;
    for (auto& face : read_step(beside(s.at("step")), place)) faces.push_back(std::move(face));
    return faces;
  }
  if (s.has("stl")) {
    const bool flat = s.at("normals").one_of({"facet", "interpolated"}) == "facet";
    const double crease = s.has("crease_deg") ? s.at("crease_deg").number_in(0.1, 90.0) : 30.0;
    return {read_stl(beside(s.at("stl")), place, flat ? 0.0 : crease)};
  }
  const JsonNode b = s.at("bspline");
  const JsonNode surface = b.json().is_string() ? JsonNode::read(beside(b)) : b;
  surface.only({"format", "version", "degree", "knots_u", "knots_v", "points_mm", "weights", "trim", "note"});
  surface.at("format").one_of({"lucerna-bench-surface"});
  surface.at("version").whole(1, 1);
  return {read_bspline(surface, place)};
}

/// Farther coordinates are no optic, and too large for float32 to be of use.
constexpr double kFarthestMm = 1e6;

void check_extent(const Surface& surface, const JsonNode& s) {
  for (const Vec3& p : surface.triangles().corners) {
    const auto near = [](double x) { return std::abs(x) <= kFarthestMm; };
    if (!(near(p.x) && near(p.y) && near(p.z)))
      s.fail("a surface that reaches beyond 1e6 mm", "one within 1e6 mm of the origin");
  }
}

std::vector<Part> read_parts(const JsonNode& s, const Task& task) {
  s.only({"name", "role", "stl", "step", "normals", "crease_deg", "bspline", "place", "flip",
          "refractive_index"});
  Part part;
  part.name = s.at("name").text();
  const std::string role = s.at("role").one_of(task.optics.roles);
  part.role = role == "mirror" ? Role::mirror : role == "absorber" ? Role::absorber : Role::interface;
  if (part.role == Role::interface)
    part.refractive_index = s.at("refractive_index").number_in(task.optics.min_index, task.optics.max_index);
  part.flip = s.has("flip") && s.at("flip").boolean();
  std::vector<Part> out;
  for (const auto& surface : read_surfaces(s)) {
    check_extent(*surface, s);
    part.surface = surface;
    out.push_back(part);
  }
  return out;
}

std::vector<Part> read_all_parts(const JsonNode& surfaces, const Task& task) {
  std::vector<Part> out;
  for (const JsonNode& surface : surfaces.items()) {
    for (Part& part : read_parts(surface, task)) out.push_back(std::move(part));
  }
  if (out.empty()) surfaces.fail("one surface or more");
  if (out.size() > 1000) surfaces.fail("1000 surfaces at most");
  for (const Part& p : out) {
    if (p.role == Role::interface && p.refractive_index != out.front().refractive_index)
      surfaces.fail("two refractive indices", "one index for all interfaces");
  }
  return out;
}

Stated read_stated(const JsonNode& s) {
  s.only({"free_parameters", "wall_s", "cpu_s", "machine", "program", "method"});
  Stated out;
  out.free_parameters = s.at("free_parameters").whole(0, 1'000'000'000);
  out.wall_s = s.at("wall_s").number_in(0.0, 1e9);
  if (s.has("cpu_s")) out.cpu_s = s.at("cpu_s").number_in(0.0, 1e12);
  out.machine = s.at("machine").text();
  out.program = s.at("program").text();
  out.method = s.at("method").text();
  return out;
}

}  // namespace

Submission::Submission(const std::string& path, const Task& task) : file(path) {
  const JsonNode s = JsonNode::read(path);
  s.only({"format", "version", "task", "name", "author", "surfaces", "light_table", "target_place", "stated",
          "note"});
  s.at("format").one_of({"lucerna-bench-submission"});
  s.at("version").whole(1, 1);
  s.at("task").one_of({task.id});
  name = s.at("name").text();
  author = s.at("author").text();
  if (s.has("surfaces") == s.has("light_table"))
    s.fail(s.has("surfaces") ? "both of surfaces and light_table" : "neither surfaces nor light_table",
           "one of the two keys");
  if (s.has("light_table")) {
    if (task.definition.at("target").at("kind").text() != "angle")
      s.at("light_table").fail("surfaces: only two-dimensional tasks take a light table");
    light_table = read_light_table(beside(s.at("light_table")));
  } else {
    parts = read_all_parts(s.at("surfaces"), task);
  }
  if (s.has("target_place")) {
    if (!task.free_target) s.at("target_place").fail("no target_place: this task fixes it");
    target_place = s.at("target_place").frame();
  }
  stated = read_stated(s.at("stated"));
  if (light_table) return;
  std::vector<const Surface*> surfaces;
  for (const Part& p : parts) surfaces.push_back(p.surface.get());
  for (const Limit& l : task.limits) limits.push_back(check_limit(l, surfaces));
}

}  // namespace bench
