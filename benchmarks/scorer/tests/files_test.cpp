// SPDX-License-Identifier: Apache-2.0
// Task files and submissions: those of the suite are whole, broken ones are refused with file, place, found
// and expected.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "output.h"
#include "support.h"

namespace bench::test {
namespace {

namespace fs = std::filesystem;

TEST(Tasks, AllAreWhole) {
  std::set<std::string> found;
  const JsonNode sources = JsonNode::read(BENCH_TASKS "/../sources/sources.json").at("sources");
  for (const auto& entry : fs::directory_iterator(BENCH_TASKS)) {
    SCOPED_TRACE(entry.path().string());
    const Task task(entry.path().string());
    EXPECT_EQ(task.id + ".json", entry.path().filename().string());
    EXPECT_FALSE(task.limits.empty());
    found.insert(task.id.substr(0, 4));
    RayRandom random(1, 1);
    EXPECT_NEAR(length(task.source->ray(1, random).direction), 1.0, 1e-12);
    const Target target(task.definition.at("target"));
    double light = 0.0;
    for (const double f : target.box_target()) light += f;
    EXPECT_TRUE(light > 0.0 || target.road());
    if (task.id.starts_with("LB-1")) continue;
    EXPECT_TRUE(sources.has(task.definition.at("frozen_source").text()));
  }
  EXPECT_EQ(found, (std::set<std::string>{"LB-1", "LB-2", "LB-3", "LB-4", "LB-5", "LB-6"}));
}

const Json kTask = task_json({{"emitter", "disk"}, {"radius_mm", 1.0}},
                             {{"kind", "far_field"}, {"axis", "-z"}, {"function", "wall_washer"}});
const Json kGood = submission_json({mirror_json(bowl_json(0.01, 10.0), place(5.0, -1.0))});

/// What is said of a submission in which the value at `pointer` is another.
std::string said(const std::string& pointer, const Json& value) {
  const TestFolder folder;
  Json s = kGood;
  s[Json::json_pointer(pointer)] = value;
  const Task task(folder.write("task.json", kTask));
  const std::string file = folder.write("mine.json", s);
  std::string message = refusal([&] { Submission(file, task); });
  if (message.rfind(file, 0) == 0) message = message.substr(file.size() - std::string("mine.json").size());
  return message;
}

TEST(Submissions, BrokenOnesAreRefusedWithPlaceFoundAndExpected) {
  EXPECT_EQ(said("/name", "x"), "");
  EXPECT_EQ(said("/task", "LB-9"), "mine.json: /task: found \"LB-9\", expected one of test");
  EXPECT_EQ(said("/format", "x"),
            "mine.json: /format: found \"x\", expected one of lucerna-bench-submission");
  EXPECT_EQ(said("/stated/wall_s", "long"), "mine.json: /stated/wall_s: found \"long\", expected a number");
  EXPECT_EQ(said("/stated/free_parameters", 1.5),
            "mine.json: /stated/free_parameters: found 1.5, expected a whole number from 0 to 1000000000");
  EXPECT_EQ(said("/surfaces", Json::array()), "mine.json: /surfaces: found [], expected one surface or more");
  EXPECT_EQ(said("/surfaces/0/role", "interface"),
            "mine.json: /surfaces/0/role: found \"interface\", expected one of mirror, absorber");
  EXPECT_NE(said("/surfaces/0/colour", 1).find("mine.json: /surfaces/0: found the unknown key colour"),
            std::string::npos);
  EXPECT_NE(said("/surfaces/0/place/x_axis", {0, 0, 1}).find("mine.json: /surfaces/0/place: found"),
            std::string::npos);
  EXPECT_NE(said("/surfaces/0/bspline/points_mm/1/2", {0, 0})
                .find("/bspline/points_mm/1/2: found [0,0], expected 3"),
            std::string::npos);
  EXPECT_EQ(
      said("/surfaces/0/place/origin_mm", {0, 0, 2e6}),
      "mine.json: /surfaces/0: found a surface that reaches beyond 1e6 mm, expected one within 1e6 mm of "
      "the origin");
  EXPECT_NE(said("/surfaces/0/bspline/points_mm/1/1/2", 1e300).find("expected coordinates within 1e6 mm"),
            std::string::npos);
  EXPECT_NE(said("/target_place", place(0.0)).find("this task fixes it"), std::string::npos);
}

TEST(Submissions, FilesStayInTheirFolder) {
  Json stl{{"name", "m"}, {"role", "mirror"}, {"stl", "../a.stl"}, {"normals", "facet"}};
  EXPECT_NE(said("/surfaces/0", stl).find("expected a file in the folder of the submission"),
            std::string::npos);
  stl["stl"] = "/etc/passwd";
  EXPECT_NE(said("/surfaces/0", stl).find("expected a file in the folder of the submission"),
            std::string::npos);
  stl["stl"] = "none.stl";
  EXPECT_NE(said("/surfaces/0", stl).find("none.stl: file: found nothing that can be opened"),
            std::string::npos);
}

TEST(Submissions, TextThatIsNoJsonIsRefusedWithItsByte) {
  const TestFolder folder;
  const Task task(folder.write("task.json", kTask));
  const std::string file = folder.write("mine.json", std::string("{\"format\": }"));
  EXPECT_EQ(refusal([&] { Submission(file, task); }),
            file + ": byte 12: found text that is no JSON, expected JSON (RFC 8259)");
  const auto said = [&](const std::string& text) {
    return refusal([&] { Submission(folder.write("mine.json", text), task); });
  };
  EXPECT_EQ(said("{\"name\": 1e999}"),
            file + ": file: found a number beyond 1e308, expected numbers that a double holds");
  const std::string deep = "{\"name\": " + std::string(100'000, '[') + std::string(100'000, ']') + "}";
  EXPECT_EQ(said(deep), file + ": file: found lists or objects more than 50 deep, expected 50 at most");
  EXPECT_EQ(said("{\"name\": " + std::string(100'000, '[')),
            file + ": file: found lists or objects more than 50 deep, expected 50 at most");
}

TEST(Tasks, BrokenOnesAreRefused) {
  const TestFolder folder;
  Json task = kTask;
  task["optics"]["reflectance"] = 1.1;
  EXPECT_NE(refusal([&] { Task(folder.write("task.json", task)); }).find("/optics/reflectance: found 1.1"),
            std::string::npos);
  task = kTask;
  task.erase("target");
  EXPECT_NE(refusal([&] { Task(folder.write("task.json", task)); }).find("found no key target"),
            std::string::npos);
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Output, FilesAreWholeOrNotThere) {
  const TestFolder folder;
  const fs::path file = folder.write("out.txt", std::string("old"));
  // A second name of the old file shows that the new one takes its place, and is not written into it.
  fs::create_hard_link(file, file.parent_path() / "witness.txt");
  write_whole(file.string(), "new");
  EXPECT_EQ(text_of(file), "new");
  EXPECT_EQ(text_of(file.parent_path() / "witness.txt"), "old");
  const fs::path taken = file.parent_path() / "taken";
  fs::create_directories(taken / "by a folder");
  EXPECT_NE(refusal([&] { write_whole(taken.string(), "x"); }).find("a place that cannot be written"),
            std::string::npos);
  EXPECT_NE(refusal([&] { write_whole((taken / "none" / "x").string(), "x"); }).find("taken/none/x: file:"),
            std::string::npos);
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(file.parent_path()))
    names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{"out.txt", "witness.txt", "taken"}));
}

}  // namespace
}  // namespace bench::test
