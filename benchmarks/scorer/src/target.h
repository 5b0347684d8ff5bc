// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "json_node.h"
#include "road.h"
#include "vec.h"

namespace bench {

/// Boxes a side at the finest; 24 and 12 are sums of these.
inline constexpr int kBoxes = 48;

/// Where a ray that left ended, for all figures. Numbers of cells, -1 for none.
struct Landing {
  int box = -1;
  bool in_window = false;
  /// Cells of NMAE and RSD: two with their shares where the cells are tents, else one.
  std::array<int, 2> cell{-1, -1};
  double share_of_first = 1.0;
  /// Of a road.
  Deposits deposits;
};

/// A task's target with the boxes of its error and the cells of NMAE and RSD. Immutable; thread safe.
///
/// The window, whose light makes the efficiency: the rectangle (far_field), +- the function's edge (angle),
/// the lit shape (plane).
///
/// - `far_field`: boxes of direction cosines (u, v) about `axis`, measured in sr.
/// - `angle` (two-dimensional tasks): boxes of the sine of the angle phi from `axis` in the plane y = 0,
///   measured in rad; cells are 181 tents a degree apart.
/// - `plane`: boxes of places, measured in mm2.
/// - `road`: has no boxes and no cells, but sums of its own. The window is the carriageway.
class Target {
 public:
  /// `place` replaces that of the file where the task leaves it free. Throws InputError.
  explicit Target(const JsonNode& target, const Frame* place = nullptr);
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  /// Of a ray's last leg.
  Landing land(const Vec3& origin, const Vec3& direction) const;

  /// The rectangle: 99.5 % of the target's flux along each axis; in the coordinates above.
  std::array<double, 2> low() const { return low_; }
  std::array<double, 2> high() const { return high_; }
  /// Rows of boxes: 48, or 1 in two dimensions.
  int rows() const { return is_angle() ? 1 : kBoxes; }
  /// By box (row * 48 + column): the measure and the target's integral over it (any unit).
  const std::vector<double>& box_measure() const { return box_measure_; }
  const std::vector<double>& box_target() const { return box_target_; }
  /// By cell of NMAE and RSD: of the plane's window, tents, or the boxes (far_field). `steady` marks those
  /// that count for RSD: in the window less 5 % of its size.
  const std::vector<double>& cell_target() const { return cell_target_; }
  const std::vector<char>& cell_steady() const { return cell_steady_; }
  /// Is the target one value all over its window, so that RSD has a meaning?
  bool is_uniform() const { return uniform_; }
  bool is_angle() const { return kind_ == Kind::angle; }
  const std::optional<Road>& road() const { return road_; }

 private:
  enum class Kind { far_field, angle, plane, road };
  using Density = std::function<double(double u, double v)>;
  struct Rectangle {
    std::array<double, 2> low, high;
  };

  void read_function(const JsonNode& t);
  void read_plane_function(const JsonNode& t);
  void set_rectangle(const JsonNode& t);
  void set_boxes();
  void set_tents();
  void set_plane_cells(const JsonNode& t);
  /// Sums of measure and of the target's integral over a rectangle.
  std::array<double, 2> integral(const Rectangle& r, int points) const;
  bool in_shape(double u, double v, double shrunk) const;

  Kind kind_;
  Frame frame_;
  Density density_;
  std::optional<Road> road_;
  bool uniform_ = false, disk_ = false;
  double min_cosine_ = 0.0, edge_deg_ = 90.0;
  std::array<double, 2> half_{1.0, 1.0}, low_{-1.0, -1.0}, high_{1.0, 1.0};
  std::array<double, 2> window_low_{-1.0, -1.0}, window_high_{1.0, 1.0};
  std::array<int, 2> cells_{kBoxes, kBoxes};
  std::vector<double> box_measure_, box_target_, cell_target_;
  std::vector<char> cell_steady_;
};

}  // namespace bench
