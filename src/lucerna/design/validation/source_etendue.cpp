// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/source_etendue.h"

#include "lucerna/source/emitters/luminance_source.h"
#include "lucerna/source/model/model_etendue.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kCurveRays = std::uint64_t{1} << 18;

}  // namespace

SourceEtendue::SourceEtendue(const DesignRays& rays) : rays_(rays.first(kCurveRays)) {
  if (rays.sources().size() == 1) only_ = rays.sources()[0].rays.get();
}

const EtendueCurve& SourceEtendue::quick() {
  if (only_ != nullptr && luminance_of(*only_) != nullptr) return searched();
  if (!quick_) quick_ = etendue_curve(rays_);
  return *quick_;
}

const EtendueCurve& SourceEtendue::searched() {
  if (!searched_ && only_ != nullptr) searched_ = known_etendue_curve(*only_);
  if (!searched_) searched_ = searched_etendue_curve(rays_);
  return *searched_;
}

}  // namespace lucerna
