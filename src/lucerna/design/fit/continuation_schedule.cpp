// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/continuation_schedule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// Knots (per direction) that a zero-etendue solution begins with: more only follow its facets.
constexpr int kKnotsOfGuesses = 4;

/// Weight of roughness in the first stages, where slopes are measured in half widths of the window: enough
/// against folds that coarse bins do not see, too little to hold the light back.
constexpr double kFirstSmoothing = 0.03;

/// Half the window's angle (its sine, for squares of direction cosines).
double half_angle(const TentBins& bins) {
  if (!bins.is_plane()) return bins.extent();
  const double across = std::hypot(bins.half_x_mm(), bins.half_y_mm());
  return std::atan2(across, length(bins.axes().origin_mm()));
}

/// Gathers stages, leaving out what repeats.
class Stages {
 public:
  explicit Stages(std::uint64_t max_rays) : max_rays_(max_rays) {}

  void add(FitStage stage) {
    stage.rays = std::min(max_rays_, stage.rays);
    if (!all_.empty()) {
      const FitStage& last = all_.back();
      if (last.rays == stage.rays && last.bins == stage.bins && last.intervals_x == stage.intervals_x &&
          last.intervals_y == stage.intervals_y && last.smoothing == stage.smoothing &&
          last.cutoff == stage.cutoff) {
        all_.back().screening |= stage.screening;
        return;
      }
    }
    all_.push_back(stage);
  }
  std::vector<FitStage> take() { return std::move(all_); }

 private:
  std::uint64_t max_rays_;
  std::vector<FitStage> all_;
};

std::uint64_t two_to(int n) { return std::uint64_t{1} << n; }

std::vector<FitStage> stages_of_revolution(int n, int ny, int k, double smoothing, const ScheduleOptions& o) {
  // A ring is one number: fewer rings than parameters would leave the shape open.
  const int few = std::min(n, 4), coarse = std::min(k, std::max(k / 2, n + 6));
  Stages stages(o.rays);
  stages.add({few, ny, k / 2, 1.2, two_to(14), 30, 0.03, smoothing});
  stages.add({n, ny, coarse, 1.1, two_to(15), 30, 0.03, 0.1 * smoothing});
  stages.add({n, ny, k, 1.0, two_to(16), 40, 0.02});
  stages.add({n, ny, k, 1.0, two_to(18), 30, 0.01, 0.0, true});
  stages.add({n, ny, k, 1.0, two_to(20), 30, 0.02});
  stages.add({n, ny, k, 1.0, two_to(22), 30, 0.02});
  return stages.take();
}

/// Most intervals with which the search for basins is made: more cannot be distinguished by so few rays, and
/// fewer than the shape's own would not show what its basin is worth.
constexpr int kSearchKnots = 8;

/// From light that costs the more the farther it has to go, to light nearly as it is.
void add_search(const std::array<int, 2>& knots, int k, double smoothing, Stages& stages) {
  if (std::max(knots[0], knots[1]) > kSearchKnots) return;
  const auto add = [&](double cutoff, std::uint64_t rays, double share) {
    const int bins = std::max(knots[0], knots[1]) <= 4 ? k / 3 : k / 2;
    FitStage stage{knots[0], knots[1], bins, 1.0, rays, 30, 0.02, share * smoothing};
    stage.cutoff = cutoff;
    stage.search = true;
    stages.add(stage);
  };
  add(1.0, two_to(14), 0.01);
  add(3.0, two_to(14), 0.002);
  add(8.0, two_to(15), 0.0);
}

}  // namespace

ContinuationSchedule::ContinuationSchedule(std::vector<FitStage> stages) : stages_(std::move(stages)) {
  while (search_stages_ < stages_.size() && stages_[search_stages_].search) ++search_stages_;
  LUCERNA_CHECK(search_stages_ < stages_.size(), "a fit without stages");
}

std::size_t ContinuationSchedule::screening() const {
  std::size_t stage = 0;
  while (stage + 1 < stages_.size() && !stages_[stage].screening) ++stage;
  return stage;
}

bool ContinuationSchedule::screens_from(std::size_t stage) const {
  while (stage < stages_.size() && !stages_[stage].screening) ++stage;
  return stage < stages_.size();
}

std::size_t ContinuationSchedule::first_with(int intervals) const {
  std::size_t stage = search_stages_;
  while (stage < screening() && stages_[stage].intervals_x < intervals) ++stage;
  return stage;
}

std::size_t ContinuationSchedule::entry(InitialKnots entry) const {
  if (entry == InitialKnots::few_knots) return search_stages_;
  if (entry == InitialKnots::own_knots) return first_with(kKnotsOfGuesses);
  return std::min(screening() + 1, stages_.size() - 1);
}

ContinuationSchedule ContinuationSchedule::up_to_screening() const {
  return ContinuationSchedule(
      {stages_.begin(), stages_.begin() + static_cast<std::ptrdiff_t>(screening()) + 1});
}

ContinuationSchedule continuation_schedule(const DesignShape& shape, const TentBins& bins,
                                           const ScheduleOptions& o) {
  const int nx = shape.intervals_x(), ny = shape.intervals_y(), k = bins.count();
  const double smoothing = kFirstSmoothing / std::pow(half_angle(bins), 2);
  if (shape.is_revolution()) return ContinuationSchedule(stages_of_revolution(nx, ny, k, smoothing, o));
  // Knots halved until few are left.
  std::vector<std::array<int, 2>> knots{{nx, ny}};
  while (std::max(knots.back()[0], knots.back()[1]) > 3) {
    const int y = shape.is_trough() ? ny : (knots.back()[1] + 1) / 2;
    knots.push_back({(knots.back()[0] + 1) / 2, y});
  }
  std::reverse(knots.begin(), knots.end());
  Stages stages(o.rays);
  add_search({nx, ny}, k, smoothing, stages);
  for (const auto& [x, y] : knots) {
    if (std::max(x, y) > 6) break;
    stages.add({x, y, k / 4, 1.2, two_to(15), 30, 0.03, smoothing});
  }
  for (const auto& [x, y] : knots) {
    const int max = std::max(x, y);
    if (max <= 3 && knots.size() > 1) continue;
    const bool own = x == nx && y == ny;
    // Twice as many bins across as knots, and more: three bins for each parameter.
    if (max <= 6) stages.add({x, y, k / 3, 1.0, two_to(15), 30, 0.02, own ? 0.0 : 0.1 * smoothing});
    if (max <= 10) stages.add({x, y, k / 2, 1.0, two_to(17), 30, 0.03});
  }
  // The screening stage, where restarts are compared.
  const bool many = std::max(nx, ny) > 10;
  stages.add({nx, ny, many ? k : k / 2, 1.0, two_to(17), 30, 0.03, 0.0, true});
  if (!many) stages.add({nx, ny, k / 2, 1.0, two_to(20), 30, 0.02});
  if (many) stages.add({nx, ny, k, 1.0, two_to(18), 30, 0.02});
  const auto fine = [&](int doublings, std::uint64_t rays, double gain) {
    const int y = shape.is_trough() ? ny : ny << doublings;
    stages.add({nx << doublings, y, k, 1.0, rays, 30, gain, 0.0, false, true});
  };
  for (int g = 1; g <= o.knot_doublings; ++g) fine(g, two_to(18), 0.03);
  fine(o.knot_doublings, two_to(20), 0.01);
  // Many knots take up the noise of a million rays (400 parameters in 48 x 48 bins a sixth of its square).
  if (many) fine(o.knot_doublings, two_to(22), 0.01);
  return ContinuationSchedule(stages.take());
}

}  // namespace lucerna
