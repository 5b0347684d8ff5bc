// SPDX-License-Identifier: Apache-2.0
#include "tally.h"

namespace bench {

namespace {

void add(const std::vector<std::uint64_t>& from, std::vector<std::uint64_t>& to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

constexpr std::array kAllSums{&Sums::emitted,
                              &Sums::left,
                              &Sums::left_direct,
                              &Sums::window,
                              &Sums::window_lossless,
                              &Sums::rectangle,
                              &Sums::rectangle_direct,
                              &Sums::mirror,
                              &Sums::mirror_back,
                              &Sums::absorber,
                              &Sums::bulk,
                              &Sums::interface,
                              &Sums::source,
                              &Sums::wrong_side,
                              &Sums::too_many_hits};
static_assert(sizeof(Sums) == kAllSums.size() * sizeof(std::uint64_t), "a sum is missing in the list");

}  // namespace

Tally::Tally(const Target& target) {
  for (Replicate& r : replicates_) {
    r.box.assign(target.box_measure().size(), 0);
    r.cell.assign(target.cell_target().size(), 0);
    r.road.assign(target.road() ? target.road()->sums() : 0, 0);
  }
}

void Tally::leaves(std::size_t replicate, const Landing& at, double weight, double lossless, bool direct) {
  Replicate& r = replicates_[replicate];
  const std::uint64_t q = quanta(weight);
  r.sums.left += q;
  if (direct) r.sums.left_direct += q;
  if (at.in_window) {
    r.sums.window += q;
    r.sums.window_lossless += quanta(lossless);
  }
  if (at.box >= 0) {
    r.sums.rectangle += q;
    if (direct) r.sums.rectangle_direct += q;
    r.box[static_cast<std::size_t>(at.box)] += q;
  }
  const std::uint64_t first = quanta(weight * at.share_of_first);
  if (at.cell[0] >= 0) r.cell[static_cast<std::size_t>(at.cell[0])] += at.cell[1] >= 0 ? first : q;
  if (at.cell[1] >= 0) r.cell[static_cast<std::size_t>(at.cell[1])] += q - first;
  if (r.road.empty()) return;
  for (const Deposit& d : at.deposits) {
    if (d.sum >= 0) r.road[static_cast<std::size_t>(d.sum)] += quanta(weight * d.per_weight);
  }
}

Tally& Tally::operator+=(const Tally& other) {
  for (std::size_t k = 0; k < kReplicates; ++k) {
    for (const auto sum : kAllSums) replicates_[k].sums.*sum += other.replicates_[k].sums.*sum;
    add(other.replicates_[k].box, replicates_[k].box);
    add(other.replicates_[k].cell, replicates_[k].cell);
    add(other.replicates_[k].road, replicates_[k].road);
  }
  return *this;
}

}  // namespace bench
