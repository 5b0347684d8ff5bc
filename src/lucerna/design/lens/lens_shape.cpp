// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

using Corners = std::vector<OutlinePoint>;

/// Where a curve crosses itself is seen at this share of its size.
constexpr double kCoarse = 1e-3;
/// Points by which the length of a piece is measured.
constexpr int kLengthSteps = 32;

double corner_distance(const OutlinePoint& a, const OutlinePoint& b) {
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

/// Corners that cut a curve in `n` pieces of equal length; its ends are kept.
Corners resampled(const std::vector<OutlinePiece<double>>& curve, int n) {
  Corners fine{curve.front().from};
  std::vector<double> way{0.0};
  for (const OutlinePiece<double>& c : curve) {
    for (int k = 1; k <= kLengthSteps; ++k) {
      fine.push_back(k == kLengthSteps ? c.to : curve_point(c, static_cast<double>(k) / kLengthSteps).at);
      way.push_back(way.back() + corner_distance(fine[fine.size() - 2], fine.back()));
    }
  }
  Corners out{fine.front()};
  std::size_t at = 1;
  for (int i = 1; i < n; ++i) {
    const double want = way.back() * i / n;
    while (way[at] < want) ++at;
    const double share = (want - way[at - 1]) / (way[at] - way[at - 1]);
    out.push_back({std::max(1e-9, fine[at - 1][0] + share * (fine[at][0] - fine[at - 1][0])),
                   fine[at - 1][1] + share * (fine[at][1] - fine[at - 1][1])});
  }
  out.push_back(fine.back());
  return out;
}

/// The outline with the corners of free faces laid anew, and its faces.
class FormMaker {
 public:
  FormMaker(const Corners& given, double smooth_below_deg, const std::vector<bool>& free_side,
            int intervals) {
    form.smooth_below_deg = smooth_below_deg;
    const std::vector<OutlineRun> runs = outline_runs(given, smooth_below_deg);
    if (runs.empty()) throw InputError("the outline has no edge: expected faces that edges or the axis end");
    std::vector<bool> free;
    for (const OutlineRun& run : runs) {
      const bool is_free = free_side[run.from % given.size()];
      free.push_back(is_free);
      add_run(given, run, is_free, intervals);
    }
    const std::vector<OutlineRun> now = outline_runs(form.corners, smooth_below_deg);
    if (now.size() != runs.size())
      throw InputError("a face that is to be shaped has an edge within: expected more `intervals`");
    for (std::size_t i = 0; i < now.size(); ++i) form.faces.push_back({now[i], free[i]});
    for (const LensFace& face : form.faces) {
      if (face.is_free) add_moves(face);
    }
    form.parameters = count_;
  }

  LensForm form;

 private:
  void add_run(const Corners& given, const OutlineRun& run, bool is_free, int intervals) {
    const std::size_t sides = run.to - run.from;
    const bool anew = is_free && (intervals > 0 || sides < 3);
    Corners points;
    if (anew) {
      points = resampled(run_curve(given, run), intervals > 0 ? intervals : kLensIntervals);
    } else {
      for (std::size_t i = run.from; i <= run.to; ++i) points.push_back(given[i % given.size()]);
    }
    for (const OutlinePoint& p : points) {
      const bool is_there = !form.corners.empty() && (form.corners.back() == p || form.corners.front() == p);
      if (!is_there) form.corners.push_back(p);
    }
  }

  void move(std::size_t corner, const OutlinePoint& direction) {
    form.moves.push_back({corner, count_++, direction});
  }

  void add_moves(const LensFace& face) {
    const auto curve = run_curve(form.corners, face.run);
    const std::size_t n = form.corners.size();
    add_end(face.run.from % n);
    for (std::size_t i = face.run.from + 1; i < face.run.to; ++i) {
      const OutlinePoint along = curve[i - face.run.from].from_slope;
      const double length = std::hypot(along[0], along[1]);
      move(i % n, {along[1] / length, -along[0] / length});
    }
    add_end(face.run.to % n);
  }

  void add_end(std::size_t corner) {
    const auto done = [&](const CornerMove& m) { return m.corner == corner; };
    if (std::any_of(form.moves.begin(), form.moves.end(), done)) return;
    if (form.corners[corner][0] == 0.0) return move(corner, {0.0, 1.0});
    const std::size_t n = form.corners.size();
    std::vector<const LensFace*> meet;
    for (const LensFace& f : form.faces) {
      if (f.run.from % n == corner || f.run.to % n == corner) meet.push_back(&f);
    }
    if (std::all_of(meet.begin(), meet.end(), [](const LensFace* f) { return f->is_free; })) {
      move(corner, {1.0, 0.0});
      return move(corner, {0.0, 1.0});
    }
    for (const LensFace* f : meet) {
      if (f->is_free || f->run.to != f->run.from + 1) continue;
      const OutlinePoint &a = form.corners[f->run.from % n], &b = form.corners[f->run.to % n];
      const double length = corner_distance(a, b);
      return move(corner, {(b[0] - a[0]) / length, (b[1] - a[1]) / length});
    }
  }

  std::size_t count_ = 0;
};

}  // namespace

std::vector<std::size_t> LensForm::free_faces() const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i].is_free) out.push_back(i);
  }
  return out;
}

LensShape::LensShape(std::span<const OutlinePoint> outline_mm, double smooth_below_deg,
                     std::span<const std::size_t> free_sides, int intervals) {
  static_cast<void>(outline_sides(outline_mm, smooth_below_deg, kCoarse * outline_reach_mm(outline_mm)));
  const Corners corners = counter_clockwise(outline_mm);
  FormMaker made(corners, smooth_below_deg, sides_of_faces(outline_mm, smooth_below_deg, free_sides),
                 intervals);
  if (made.form.parameters == 0) throw InputError("no side of the outline is free to be shaped");
  form_ = std::make_shared<const LensForm>(std::move(made.form));
  *this = with(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(form_->parameters)));
}

LensShape LensShape::with(Eigen::VectorXd parameters) const {
  LensShape out = *this;
  out.parameters_ = std::move(parameters);
  out.corners_ = form_->corners;
  for (const CornerMove& m : form_->moves) {
    const double by = out.parameters_[static_cast<Eigen::Index>(m.parameter)];
    for (std::size_t k = 0; k < 2; ++k) out.corners_[m.corner][k] += by * m.direction[k];
  }
  return out;
}

bool LensShape::is_valid() const {
  if (!parameters_.allFinite()) return false;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    if (!(corners_[i][0] >= 0.0) || (corners_[i][0] == 0.0) != (form_->corners[i][0] == 0.0)) return false;
  }
  std::vector<OutlineRun> now;
  try {
    static_cast<void>(outline_sides(corners_, form_->smooth_below_deg, kCoarse * outline_reach_mm(corners_)));
    if (counter_clockwise(corners_) != corners_) return false;
    now = outline_runs(corners_, form_->smooth_below_deg);
  } catch (const InputError&) {
    return false;
  }
  return std::equal(now.begin(), now.end(), form_->faces.begin(), form_->faces.end(),
                    [](const OutlineRun& run, const LensFace& face) { return run == face.run; });
}

double LensShape::height_mm() const {
  const auto [low, high] =
      std::minmax_element(corners_.begin(), corners_.end(),
                          [](const OutlinePoint& a, const OutlinePoint& b) { return a[1] < b[1]; });
  return (*high)[1] - (*low)[1];
}

double LensShape::radius_mm() const {
  return (*std::max_element(corners_.begin(), corners_.end(),
                            [](const OutlinePoint& a, const OutlinePoint& b) { return a[0] < b[0]; }))[0];
}

}  // namespace lucerna
