// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lucerna/optics/shapes/outline_curve.h"
#include "lucerna/scene.h"

namespace lucerna {

/// A side of an outline that turns about z as one: a run between two edges, or an edge and the axis.
struct LensFace {
  OutlineRun run;
  bool is_free = false;
};

/// How a parameter moves a corner.
struct CornerMove {
  std::size_t corner = 0, parameter = 0;
  OutlinePoint direction{};
};

/// What stays the same while a lens is shaped: corners to begin with, faces, and what parameters move.
struct LensForm {
  std::vector<OutlinePoint> corners;  ///< counter-clockwise
  double smooth_below_deg = 20.0;
  std::vector<LensFace> faces;
  std::vector<CornerMove> moves;
  std::size_t parameters = 0;

  /// Numbers of the faces that are free.
  std::vector<std::size_t> free_faces() const;
};

/// A body of revolution whose faces are shaped: the outline of a `Solid`. Parameters, in mm: each corner
/// within a free face moves along the normal of the face to begin with, one on the axis along it; an edge to
/// a fixed straight face slides along that face, an edge between two free faces moves along r and z, and one
/// to a fixed curve stays. All 0 to begin with. Immutable, thread safe; copies share the form.
class LensShape {
 public:
  /// `free_sides`: numbers of sides of `outline_mm` (side i leads from corner i to the next); all of the face
  /// that a side belongs to is free. `intervals`: > 0: free faces get corners that cut them in so many pieces
  /// of equal length; 0: faces of three sides and more keep theirs, others get `kLensIntervals`. Throws
  /// InputError for a number that is no side or along the axis, an outline without any edge, and as
  /// outline_sides does.
  LensShape(std::span<const OutlinePoint> outline_mm, double smooth_below_deg,
            std::span<const std::size_t> free_sides, int intervals);

  const LensForm& form() const { return *form_; }
  std::size_t parameter_count() const { return form_->parameters; }
  const Eigen::VectorXd& parameters() const { return parameters_; }
  LensShape with(Eigen::VectorXd parameters) const;

  /// Counter-clockwise, as `Solid::outline_mm` has them.
  const std::vector<OutlinePoint>& corners() const { return corners_; }
  double smooth_below_deg() const { return form_->smooth_below_deg; }
  /// False where the outline or its curve crosses itself, a corner has left the half plane, or an edge has
  /// become smooth or a face broken. O(corners^2).
  bool is_valid() const;

  /// Largest minus smallest height, and the largest distance from the axis, of the corners, mm.
  double height_mm() const;
  double radius_mm() const;

 private:
  std::shared_ptr<const LensForm> form_;
  Eigen::VectorXd parameters_;
  std::vector<OutlinePoint> corners_;
};

/// Pieces of a free face where neither project nor outline say how many.
inline constexpr int kLensIntervals = 12;

/// Corner number of a run, behind the last one from the first again.
inline std::size_t corner_number(const LensForm& form, std::size_t i) { return i % form.corners.size(); }

}  // namespace lucerna
