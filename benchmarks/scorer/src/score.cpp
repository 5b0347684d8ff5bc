// SPDX-License-Identifier: Apache-2.0
#include "score.h"

#include <stdexcept>

#include "scene.h"

namespace bench {

namespace {

double real(std::uint64_t quanta) { return static_cast<double>(quanta); }

/// Shares of the emitted light in cells, by replicate.
std::vector<std::vector<double>> shares(const Tally& tally, std::vector<std::uint64_t> Replicate::*cells) {
  std::vector<std::vector<double>> out;
  for (const Replicate& r : tally.replicates()) {
    std::vector<double>& row = out.emplace_back();
    for (const std::uint64_t q : r.*cells) row.push_back(real(q) / real(r.sums.emitted));
  }
  return out;
}

Estimate share(const Tally& tally, std::uint64_t Sums::*part, std::uint64_t Sums::*less = nullptr) {
  std::vector<double> values;
  for (const Replicate& r : tally.replicates()) {
    const double off = less != nullptr ? real(r.sums.*less) : 0.0;
    values.push_back((real(r.sums.*part) - off) / real(r.sums.emitted));
  }
  return mean_of(values);
}

void set_errors(const Tally& tally, const Target& target, Score& s) {
  s.boxes = {target.box_measure(), target.box_target(), shares(tally, &Replicate::box)};
  s.n12 = box_error(merged(s.boxes, target.rows(), 12));
  s.n24 = box_error(merged(s.boxes, target.rows(), 24));
  s.n48 = box_error(s.boxes);
  const auto cells = shares(tally, &Replicate::cell);
  s.nmae =
      absolute_error({std::vector<double>(target.cell_target().size(), 1.0), target.cell_target(), cells});
  if (!target.is_uniform()) return;
  std::vector<double> steady(target.cell_steady().begin(), target.cell_steady().end());
  s.rsd = unevenness({steady, target.cell_target(), cells});
}

/// Not held where it is missed by more than two standard errors.
LimitCheck check(const char* what, const Estimate& found, double limit, bool at_least) {
  const double margin = 2.0 * found.standard_error;
  return {what, std::to_string(found.mean), std::to_string(limit) + (at_least ? " or more" : " at most"),
          at_least ? found.mean + margin >= limit : found.mean - margin <= limit};
}

std::vector<LimitCheck> check_road(const RoadScore& found, const Road& road) {
  return {check("overall uniformity", found.overall, road.min_overall(), true),
          check("lengthwise uniformity", found.lengthwise, road.min_lengthwise(), true),
          check("threshold increment", found.threshold_increment, road.max_increment(), false)};
}

}  // namespace

Score score_of(const Tally& tally, const Target& target, std::uint64_t rays) {
  for (const Replicate& r : tally.replicates()) {
    if (r.sums.emitted == 0) throw std::runtime_error("fewer rays than one run of each replicate");
  }
  Score s;
  s.rays = rays;
  if (target.road()) {
    s.road = target.road()->score(shares(tally, &Replicate::road));
    s.road_limits = check_road(*s.road, *target.road());
  } else {
    set_errors(tally, target, s);
  }
  s.efficiency = share(tally, &Sums::window);
  s.efficiency_lossless = share(tally, &Sums::window_lossless);
  s.in_rectangle = share(tally, &Sums::rectangle);
  s.outside = share(tally, &Sums::left, &Sums::rectangle);
  s.outside_direct = share(tally, &Sums::left_direct, &Sums::rectangle_direct);
  s.mirror = share(tally, &Sums::mirror);
  s.mirror_back = share(tally, &Sums::mirror_back);
  s.absorber = share(tally, &Sums::absorber);
  s.bulk = share(tally, &Sums::bulk);
  s.interface = share(tally, &Sums::interface);
  s.source = share(tally, &Sums::source);
  s.wrong_side = share(tally, &Sums::wrong_side);
  s.too_many_hits = share(tally, &Sums::too_many_hits);
  return s;
}

std::vector<std::string> faults(const Score& score, const Submission& submission) {
  constexpr double kMaxLost = 1e-4;
  std::vector<std::string> out;
  for (const auto* limits : {&submission.limits, &score.road_limits}) {
    for (const LimitCheck& c : *limits) {
      if (!c.held) out.push_back("limit " + c.limit + ": found " + c.found + ", expected " + c.allowed);
    }
  }
  if (score.wrong_side.mean > kMaxLost)
    out.push_back("light at the wrong side of an interface: found a share of " +
                  std::to_string(score.wrong_side.mean) +
                  ", expected 0.0001 at most (are the solids closed?)");
  if (score.too_many_hits.mean > kMaxLost)
    out.push_back("light that hits surfaces 200 times: found a share of " +
                  std::to_string(score.too_many_hits.mean) + ", expected 0.0001 at most");
  return out;
}

}  // namespace bench
