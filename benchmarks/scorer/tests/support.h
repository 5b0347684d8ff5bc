// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report.h"
#include "trace.h"

namespace bench::test {

using Json = nlohmann::json;

/// A folder that goes when the test ends.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "bench-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string file = (path_ / name).string();
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }
  const std::filesystem::path& path() const { return path_; }
  std::string write(const std::string& name, const Json& json) const { return write(name, json.dump(1)); }

 private:
  std::filesystem::path path_;
};

inline Json place(double z, double up = 1.0) {
  return {{"origin_mm", {0, 0, z}}, {"x_axis", {1, 0, 0}}, {"z_axis", {0, 0, up}}};
}

/// A task with a mirror of reflectance 1 and no limits.
inline Json task_json(const Json& source, const Json& target) {
  Json s = source;
  s["place"] = place(0.0);
  if (!s.contains("blocks")) s["blocks"] = false;
  return {{"format", "lucerna-bench-task"},
          {"version", 1},
          {"task", "test"},
          {"title", "a task of the tests"},
          {"source", s},
          {"optics", {{"roles", {"mirror", "absorber"}}, {"reflectance", 1.0}}},
          {"limits", Json::array()},
          {"target", target},
          {"headline", "error_48"}};
}

inline Json stated_json() {
  return {{"free_parameters", 3}, {"wall_s", 1.5}, {"machine", "m"}, {"program", "p"}, {"method", "way"}};
}

inline Json submission_json(const std::vector<Json>& surfaces) {
  return {{"format", "lucerna-bench-submission"},
          {"version", 1},
          {"task", "test"},
          {"name", "n"},
          {"author", "a"},
          {"surfaces", surfaces},
          {"stated", stated_json()}};
}

/// z = c (x^2 + y^2) over a square of half side `half`, exactly: one biquadratic piece.
inline Json bowl_json(double c, double half) {
  const double k[3] = {-half, 0.0, half}, h[3] = {half * half, -half * half, half * half};
  Json points = Json::array();
  for (int i = 0; i < 3; ++i) {
    Json row = Json::array();
    for (int j = 0; j < 3; ++j) row.push_back({k[i], k[j], c * (h[i] + h[j])});
    points.push_back(row);
  }
  const Json knots{-half, -half, -half, half, half, half};
  return {{"format", "lucerna-bench-surface"},
          {"version", 1},
          {"degree", {2, 2}},
          {"knots_u", knots},
          {"knots_v", knots},
          {"points_mm", points}};
}

inline Json mirror_json(const Json& bspline, const Json& where) {
  return {{"name", "mirror"}, {"role", "mirror"}, {"bspline", bspline}, {"place", where}};
}

struct Scored {
  Score score;
  nlohmann::ordered_json json;
};

/// Scores a submission as the program does. `files`: name and content of those beside it.
inline Scored scored(const Json& task, const Json& submission, std::uint64_t rays, unsigned threads = 1,
                     const std::map<std::string, std::string>& files = {}) {
  const TestFolder folder;
  for (const auto& [name, bytes] : files) folder.write(name, bytes);
  const Task t(folder.write("task.json", task));
  const Submission s(folder.write("submission.json", submission), t);
  const Target target(t.definition.at("target"), s.target_place ? &*s.target_place : nullptr);
  const SurfaceScene scene(s.parts);
  const Tally tally = trace(t, s.source(t), scene, target, {rays, 7, threads});
  const Score score = score_of(tally, target, whole_rays(rays, s.source(t)));
  return {score, score_json(t, s, target, score, {})};
}

/// The message of an InputError, empty where there is none.
template <class Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace bench::test
