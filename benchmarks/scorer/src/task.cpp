// SPDX-License-Identifier: Apache-2.0
#include "task.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace bench {

namespace {

Optics read_optics(const JsonNode& o) {
  o.only({"roles", "reflectance", "interface", "note"});
  Optics out;
  for (const JsonNode& r : o.at("roles").items())
    out.roles.push_back(r.one_of({"mirror", "absorber", "interface"}));
  const auto has = [&](const char* role) {
    return std::find(out.roles.begin(), out.roles.end(), role) != out.roles.end();
  };
  if (has("mirror")) out.reflectance = o.at("reflectance").number_in(0.0, 1.0);
  if (!has("interface")) return out;
  const JsonNode i = o.at("interface");
  i.only({"model", "refractive_index", "loss", "absorption_per_mm", "note"});
  out.fresnel = i.at("model").one_of({"fresnel", "fixed"}) == "fresnel";
  if (!out.fresnel) out.interface_loss = i.at("loss").number_in(0.0, 1.0);
  const auto range = i.at("refractive_index").numbers(2);
  out.min_index = range[0];
  out.max_index = range[1];
  if (!(range[0] > 1.0 && range[1] >= range[0])) i.at("refractive_index").fail("a range above 1");
  out.absorption_per_mm = i.at("absorption_per_mm").number_in(0.0, 10.0);
  return out;
}

Limit read_limit(const JsonNode& l) {
  Limit out;
  out.kind = l.at("kind").one_of({"inside_cylinder", "inside_box", "outside_sphere"});
  if (l.has("note")) out.note = l.at("note").text();
  if (out.kind == "inside_cylinder") {
    l.only({"kind", "radius_mm", "z_mm", "note"});
    out.values = l.at("z_mm").numbers(2);
    out.values.push_back(l.at("radius_mm").positive());
  } else if (out.kind == "inside_box") {
    l.only({"kind", "low_mm", "high_mm", "note"});
    out.values = l.at("low_mm").numbers(3);
    for (const double x : l.at("high_mm").numbers(3)) out.values.push_back(x);
  } else {
    l.only({"kind", "centre_mm", "radius_mm", "note"});
    out.values = l.at("centre_mm").numbers(3);
    out.values.push_back(l.at("radius_mm").positive());
  }
  return out;
}

std::string shown(const std::vector<double>& values) {
  std::ostringstream out;
  out.precision(6);
  for (std::size_t i = 0; i < values.size(); ++i) out << (i == 0 ? "" : ", ") << values[i];
  return out.str();
}

/// Corners are written as float32 in STL files: this much is not counted as beyond a limit.
constexpr double kTolerance = 1e-4;

}  // namespace

Task::Task(const std::string& file) : definition(JsonNode::read(file)) {
  definition.only({"format", "version", "task", "title", "note", "source", "frozen_source", "optics",
                   "limits", "target", "target_place", "headline", "reference"});
  definition.at("format").one_of({"lucerna-bench-task"});
  definition.at("version").whole(1, 1);
  id = definition.at("task").text();
  title = definition.at("title").text();
  headline = definition.at("headline").one_of({"error_48", "efficiency_with_losses"});
  const JsonNode s = definition.at("source");
  source = read_emitter(s);
  source_body = read_source_body(s);
  source_place = s.at("place").frame();
  optics = read_optics(definition.at("optics"));
  for (const JsonNode& l : definition.at("limits").items()) limits.push_back(read_limit(l));
  if (definition.has("target_place"))
    free_target = definition.at("target_place").one_of({"free", "fixed"}) == "free";
  definition.at("target");
}

LimitCheck check_limit(const Limit& l, const std::vector<const Surface*>& surfaces) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Vec3 low{kInf, kInf, kInf}, high{-kInf, -kInf, -kInf};
  double radius = 0.0, nearest = kInf;
  const bool sphere = l.kind == "outside_sphere";
  for (const Surface* s : surfaces) {
    if (sphere) nearest = std::min(nearest, distance(*s, {l.values[0], l.values[1], l.values[2]}));
    for (const Vec3& p : s->extent()) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      radius = std::max(radius, std::hypot(p.x, p.y));
    }
  }
  LimitCheck out{l.kind, "", "", false};
  const auto& v = l.values;
  const auto within = [](double x, double a, double b) { return x >= a - kTolerance && x <= b + kTolerance; };
  if (l.kind == "inside_cylinder") {
    out.found = "radius " + shown({radius}) + ", z " + shown({low.z, high.z}) + " mm";
    out.allowed = "radius " + shown({v[2]}) + ", z " + shown({v[0], v[1]}) + " mm";
    out.held = radius <= v[2] + kTolerance && within(low.z, v[0], v[1]) && within(high.z, v[0], v[1]);
  } else if (l.kind == "inside_box") {
    out.found = shown({low.x, low.y, low.z}) + " to " + shown({high.x, high.y, high.z}) + " mm";
    out.allowed = shown({v[0], v[1], v[2]}) + " to " + shown({v[3], v[4], v[5]}) + " mm";
    out.held = within(low.x, v[0], v[3]) && within(low.y, v[1], v[4]) && within(low.z, v[2], v[5]) &&
               within(high.x, v[0], v[3]) && within(high.y, v[1], v[4]) && within(high.z, v[2], v[5]);
  } else {
    out.found = shown({nearest}) + " mm from the centre";
    out.allowed = shown({v[3]}) + " mm or more";
    out.held = nearest >= v[3] - kTolerance;
  }
  return out;
}

}  // namespace bench
