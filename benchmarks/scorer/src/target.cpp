// SPDX-License-Identifier: Apache-2.0
#include "target.h"

#include <algorithm>
#include <cmath>

#include "intensity_table.h"

namespace bench {

namespace {

/// Share of the flux that is cut off at each side of the rectangle.
constexpr double kCut = 0.0025;
/// Boxes with less of a whole one's measure are slivers at the horizon: they do not count.
constexpr double kSliver = 0.01;
constexpr int kTents = 181;

double cosine(double u, double v) { return std::sqrt(std::max(0.0, 1.0 - u * u - v * v)); }
/// Angles from the axis, degrees: across x (of u) or across y (of v), with the cosine; and from the axis
/// itself.
double across(double u, double cosine) { return std::atan2(u, cosine) / kDegree; }
double from_axis(double u, double v) { return across(std::hypot(u, v), cosine(u, v)); }

double gaussian(double angle, double beam) { return std::exp2(-std::pow(2.0 * angle / beam, 2)); }
double soft_step(double x, double edge, double soft) {
  return 1.0 / (1.0 + std::exp(std::min(60.0, 4.0 * (x - edge) / (soft * edge))));
}

/// Rises to 60 degrees on the side of +x, little on the other side.
double wall_washer(double u, double v) {
  const double w = cosine(u, v), x = across(u, w), y = across(v, w);
  const double rise = 0.25 + 0.75 / (1.0 + std::exp(-(x - 12.0) / 9.0));
  return rise * soft_step(std::abs(x - 15.0), 48.0, 0.3) * std::exp2(-std::pow(y / 38.0, 2));
}

double batwing(double u, double v, double edge, double soft) {
  const double gamma = from_axis(u, v);
  if (gamma >= 89.0) return 0.0;
  return std::pow(std::cos(kDegree * std::min(gamma, 75.0)), -3.0) * soft_step(gamma, edge, soft);
}

Frame axis_frame(const std::string& axis) {
  Frame f;
  if (axis == "-z") {
    f.y = {0, -1, 0};
    f.z = {0, 0, -1};
  }
  return f;
}

/// Where `share` of a row of cells over [low, high] lies below; linear within a cell.
double quantile(const std::vector<double>& flux, double low, double high, double share) {
  double total = 0.0, sum = 0.0;
  for (const double f : flux) total += f;
  const double step = (high - low) / static_cast<double>(flux.size());
  for (std::size_t i = 0; i < flux.size(); ++i) {
    if (sum + flux[i] >= share * total && flux[i] > 0.0)
      return low + step * (static_cast<double>(i) + std::clamp((share * total - sum) / flux[i], 0.0, 1.0));
    sum += flux[i];
  }
  return high;
}

}  // namespace

Target::Target(const JsonNode& t, const Frame* place) {
  const std::string kind = t.at("kind").one_of({"far_field", "angle", "plane", "road"});
  kind_ = kind == "plane"   ? Kind::plane
          : kind == "angle" ? Kind::angle
          : kind == "road"  ? Kind::road
                            : Kind::far_field;
  if (kind_ == Kind::road) {
    frame_ = place != nullptr ? *place : t.at("place").frame();
    road_.emplace(t, frame_.local_point({}).z);
    return;
  }
  if (kind_ == Kind::plane) {
    frame_ = place != nullptr ? *place : t.at("place").frame();
    if (t.has("max_angle_deg")) min_cosine_ = std::cos(kDegree * t.at("max_angle_deg").number_in(0.1, 90.0));
    read_plane_function(t);
  } else {
    frame_ = axis_frame(t.at("axis").one_of({"-z", "+z"}));
    read_function(t);
  }
  set_rectangle(t);
  set_boxes();
  if (kind_ == Kind::plane) {
    set_plane_cells(t);
  } else if (is_angle()) {
    set_tents();
  } else {  // the boxes are the cells
    window_low_ = low_;
    window_high_ = high_;
    cell_target_ = box_target_;
    cell_steady_.assign(box_target_.size(), 1);
  }
}

void Target::read_function(const JsonNode& t) {
  t.only({"kind", "axis", "function", "beam_x_deg", "beam_y_deg", "beam_deg", "edge_deg", "soft", "power",
          "c_step_deg", "gamma_step_deg", "rows", "note"});
  const std::string name = t.at("function")
                               .one_of({"cosine_power", "gaussian_beam", "round_gaussian_beam", "batwing",
                                        "wall_washer", "table"});
  const auto degrees = [&](const char* key) { return t.at(key).number_in(0.01, 180.0); };
  if (name == "cosine_power") {
    const double power = t.at("power").number_in(0.0, 1000.0), edge = t.at("edge_deg").number_in(0.01, 90.0);
    const double sine = std::sin(kDegree * edge);
    uniform_ = is_angle() && power == 0.0;
    edge_deg_ = edge;
    density_ = [=](double u, double v) {
      const double s2 = u * u + v * v;
      return s2 > sine * sine ? 0.0 : std::pow(1.0 - std::min(1.0, s2), 0.5 * power);
    };
  } else if (kind_ == Kind::angle) {
    t.at("function").fail("cosine_power for the kind angle");
  } else if (name == "gaussian_beam") {
    const double bx = degrees("beam_x_deg"), by = degrees("beam_y_deg");
    density_ = [=](double u, double v) {
      const double w = cosine(u, v);
      return gaussian(across(u, w), bx) * gaussian(across(v, w), by);
    };
  } else if (name == "round_gaussian_beam") {
    const double beam = degrees("beam_deg");
    density_ = [=](double u, double v) { return gaussian(from_axis(u, v), beam); };
  } else if (name == "batwing") {
    const double edge = degrees("edge_deg"), soft = t.at("soft").positive();
    density_ = [=](double u, double v) { return batwing(u, v, edge, soft); };
  } else if (name == "table") {
    density_ = [table = IntensityTable(t)](double u, double v) { return table.at(u, v); };
  } else {
    density_ = wall_washer;
  }
}

void Target::read_plane_function(const JsonNode& t) {
  t.only({"kind", "place", "function", "size_mm", "radius_mm", "cells", "max_angle_deg", "note"});
  uniform_ = true;
  if (t.at("function").one_of({"uniform_rectangle", "uniform_disk"}) == "uniform_disk") {
    disk_ = true;
    half_[0] = half_[1] = t.at("radius_mm").positive();
  } else {
    const auto size = t.at("size_mm").numbers(2);
    half_ = {0.5 * size[0], 0.5 * size[1]};
    if (!(half_[0] > 0.0 && half_[1] > 0.0)) t.at("size_mm").fail("two sizes > 0");
  }
  density_ = [this](double x, double y) { return in_shape(x, y, 1.0) ? 1.0 : 0.0; };
}

bool Target::in_shape(double u, double v, double shrunk) const {
  if (disk_) return u * u + v * v <= shrunk * shrunk * half_[0] * half_[0];
  return std::abs(u) <= shrunk * half_[0] && std::abs(v) <= shrunk * half_[1];
}

std::array<double, 2> Target::integral(const Rectangle& r, int points) const {
  const double du = (r.high[0] - r.low[0]) / points;
  const int across = is_angle() ? 1 : points;
  const double dv = is_angle() ? 1.0 : (r.high[1] - r.low[1]) / points;
  std::array<double, 2> sum{0.0, 0.0};
  for (int j = 0; j < across; ++j) {
    const double v = is_angle() ? 0.0 : r.low[1] + (j + 0.5) * dv;
    for (int i = 0; i < points; ++i) {
      const double u = r.low[0] + (i + 0.5) * du;
      const double w2 = kind_ == Kind::plane ? 1.0 : 1.0 - u * u - v * v;
      if (w2 <= 0.0) continue;
      const double measure = du * dv / std::sqrt(w2);
      sum[0] += measure;
      sum[1] += measure * density_(u, v);
    }
  }
  return sum;
}

void Target::set_rectangle(const JsonNode& t) {
  const int fine = is_angle() ? 1 << 17 : 1024, across = is_angle() ? 1 : fine;
  std::vector<double> by_u(static_cast<std::size_t>(fine), 0.0), by_v(static_cast<std::size_t>(across), 0.0);
  const double du = 2.0 * half_[0] / fine, dv = is_angle() ? 0.0 : 2.0 * half_[1] / fine;
  double total = 0.0;
  for (int j = 0; j < across; ++j) {
    for (int i = 0; i < fine; ++i) {
      const double u = (i + 0.5) * du - half_[0], v = is_angle() ? 0.0 : (j + 0.5) * dv - half_[1];
      const double w2 = kind_ == Kind::plane ? 1.0 : 1.0 - u * u - v * v;
      if (w2 <= 0.0) continue;
      const double flux = density_(u, v) / std::sqrt(w2);
      by_u[static_cast<std::size_t>(i)] += flux;
      by_v[static_cast<std::size_t>(j)] += flux;
      total += flux;
    }
  }
  if (!(total > 0.0)) t.fail("a target with light");
  low_ = {quantile(by_u, -half_[0], half_[0], kCut), quantile(by_v, -half_[1], half_[1], kCut)};
  high_ = {quantile(by_u, -half_[0], half_[0], 1.0 - kCut), quantile(by_v, -half_[1], half_[1], 1.0 - kCut)};
  if (is_angle()) {
    low_[1] = -1.0;
    high_[1] = 1.0;
  }
}

void Target::set_boxes() {
  const double su = (high_[0] - low_[0]) / kBoxes, sv = (high_[1] - low_[1]) / rows();
  const int points = is_angle() ? 4096 : 32;
  for (int j = 0; j < rows(); ++j) {
    for (int i = 0; i < kBoxes; ++i) {
      const Rectangle r{{low_[0] + i * su, low_[1] + j * sv},
                        {low_[0] + (i + 1) * su, low_[1] + (j + 1) * sv}};
      const auto sum = integral(r, points);
      const bool counts = sum[0] >= kSliver * su * (is_angle() ? 1.0 : sv);
      box_measure_.push_back(counts ? sum[0] : 0.0);
      box_target_.push_back(sum[1]);
    }
  }
}

void Target::set_tents() {
  for (int k = 0; k < kTents; ++k) {
    // A tent's own integral of the target, by midpoints of a thousandth of a degree.
    double sum = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const double off = (i + 0.5) / 1000.0 - 1.0, phi = k - 90.0 + off;
      if (std::abs(phi) < 90.0) sum += (1.0 - std::abs(off)) * density_(std::sin(kDegree * phi), 0.0);
    }
    cell_target_.push_back(sum);
    cell_steady_.push_back(std::abs(k - 90.0) + 1.0 <= 0.95 * edge_deg_ ? 1 : 0);
  }
}

void Target::set_plane_cells(const JsonNode& t) {
  const auto n = t.at("cells").items();
  if (n.size() != 2) t.at("cells").fail("two whole numbers");
  cells_ = {static_cast<int>(n[0].whole(1, 1000)), static_cast<int>(n[1].whole(1, 1000))};
  window_low_ = {-half_[0], -half_[1]};
  window_high_ = half_;
  const double su = 2.0 * half_[0] / cells_[0], sv = 2.0 * half_[1] / cells_[1];
  for (int j = 0; j < cells_[1]; ++j) {
    for (int i = 0; i < cells_[0]; ++i) {
      const double u = window_low_[0] + i * su, v = window_low_[1] + j * sv;
      cell_target_.push_back(integral({{u, v}, {u + su, v + sv}}, 32)[1]);
      const bool steady = in_shape(u, v, 0.95) && in_shape(u + su, v, 0.95) && in_shape(u, v + sv, 0.95) &&
                          in_shape(u + su, v + sv, 0.95);
      cell_steady_.push_back(steady ? 1 : 0);
    }
  }
}

Landing Target::land(const Vec3& origin, const Vec3& direction) const {
  Landing out;
  Vec3 d = frame_.local_vector(direction);
  if (road_) {
    out.in_window = road_->land(frame_.local_point(origin), d, out.deposits);
    return out;
  }
  double u = d.x, v = d.y;
  if (kind_ == Kind::plane) {
    const Vec3 o = frame_.local_point(origin);
    if (!(d.z < 0.0 && o.z >= 0.0) || -d.z < min_cosine_) return out;
    u = o.x - o.z / d.z * d.x;
    v = o.y - o.z / d.z * d.y;
    out.in_window = in_shape(u, v, 1.0);
  } else if (is_angle()) {
    const double phi = std::atan2(u, d.z) / kDegree + 90.0;
    if (!(phi >= 0.0 && phi <= 180.0)) return out;
    const int k = std::min(static_cast<int>(phi), kTents - 2);
    out.cell = {k, k + 1};
    out.share_of_first = 1.0 - (phi - k);
    out.in_window = std::abs(phi - 90.0) <= edge_deg_;
    v = 0.0;
  } else if (!(d.z > 0.0)) {
    return out;
  }
  const auto index = [](double x, double low, double high, int n) {
    const double at = std::floor((x - low) / (high - low) * n);
    return at >= 0.0 && at < n ? static_cast<int>(at) : -1;
  };
  const int i = index(u, low_[0], high_[0], kBoxes), j = index(v, low_[1], high_[1], rows());
  if (i >= 0 && j >= 0) out.box = j * kBoxes + i;
  if (kind_ == Kind::far_field) out.in_window = out.box >= 0;
  if (!is_angle()) {
    const int a = index(u, window_low_[0], window_high_[0], cells_[0]);
    const int b = index(v, window_low_[1], window_high_[1], cells_[1]);
    if (a >= 0 && b >= 0) out.cell[0] = b * cells_[0] + a;
  }
  return out;
}

}  // namespace bench
