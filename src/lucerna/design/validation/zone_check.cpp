// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/zone_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

/// Cells by replicates: intensity or illuminance, of the sums that a member of BoxSums holds.
class ZoneLight {
 public:
  ZoneLight(const ZoneCells& cells, std::span<const BoxSums> replicates, double source_flux,
            const std::vector<double> BoxSums::*sums)
      : cells_(cells), value_(cells.size(), std::vector<double>(replicates.size())) {
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const double per = cells.unit() * source_flux / cells.cells()[c].measure;
      for (std::size_t r = 0; r < replicates.size(); ++r) {
        value_[c][r] = per * (replicates[r].*sums)[c] / replicates[r].emitted;
      }
      mean_.push_back(mean_estimate(value_[c]));
    }
  }

  std::size_t replicates() const { return value_.front().size(); }
  const std::vector<double>& of(std::size_t cell) const { return value_[cell]; }
  const Estimate& mean(std::size_t cell) const { return mean_[cell]; }

  /// The mean over a zone, by replicate.
  std::vector<double> over(std::size_t zone) const {
    std::vector<double> sum(replicates(), 0.0);
    double all = 0.0;
    for (std::size_t c = cells_.first(zone); c < cells_.first(zone + 1); ++c) {
      const double measure = cells_.cells()[c].measure;
      all += measure;
      for (std::size_t r = 0; r < sum.size(); ++r) sum[r] += measure * value_[c][r];
    }
    for (double& s : sum) s /= all;
    return sum;
  }
  std::size_t brightest(std::size_t zone) const { return extreme(zone, 1.0); }
  std::size_t darkest(std::size_t zone) const { return extreme(zone, -1.0); }

 private:
  std::size_t extreme(std::size_t zone, double sign) const {
    std::size_t best = cells_.first(zone);
    for (std::size_t c = best; c < cells_.first(zone + 1); ++c) {
      if (sign * mean_[c].mean > sign * mean_[best].mean) best = c;
    }
    return best;
  }

  const ZoneCells& cells_;
  std::vector<std::vector<double>> value_;
  std::vector<Estimate> mean_;
};

std::vector<double> reference_of(const ZoneLight& light, std::size_t zone, const ZoneBound& bound) {
  if (bound.reference == ZoneReference::absolute) return std::vector<double>(light.replicates(), 1.0);
  if (bound.reference == ZoneReference::mean) return light.over(bound.mean_of);
  return light.of(light.brightest(zone));
}

ZoneVerdict worse(ZoneVerdict a, ZoneVerdict b) {
  if (a == ZoneVerdict::missed || b == ZoneVerdict::missed) return ZoneVerdict::missed;
  return a == ZoneVerdict::undetermined ? a : b;
}

bool is_clearly_above_zero(const Estimate& e) {
  return e.mean > 0.0 && e.mean >= kZoneErrors * e.standard_error;
}

/// What the direct light alone makes of an upper bound in cd or lx.
void check_direct(const ZoneLight& direct, std::size_t zone, const ZoneBound& bound, ZoneBoundCheck& out) {
  if (bound.is_min || bound.reference != ZoneReference::absolute) return;
  const Estimate& most = direct.mean(direct.brightest(zone));
  out.direct = most;
  out.broken_by_direct = is_clearly_above_zero({most.mean - bound.value, most.standard_error});
}

ZoneBoundCheck check_bound(const ZoneCells& cells, const ZoneLight& light, std::size_t zone,
                           const ZoneBound& bound) {
  const std::vector<double> reference = reference_of(light, zone, bound);
  const double unit = mean_estimate(reference).mean;
  ZoneBoundCheck out{bound.key, bound.is_min, bound.value, unit};
  out.missing = -std::numeric_limits<double>::infinity();
  std::vector<double> short_by(reference.size()), ratio(reference.size());
  for (std::size_t c = cells.first(zone); c < cells.first(zone + 1); ++c) {
    for (std::size_t r = 0; r < reference.size(); ++r) {
      const double tolerance = bound.value * reference[r] - light.of(c)[r];
      short_by[r] = bound.is_min ? tolerance : -tolerance;
    }
    const Estimate e = mean_estimate(short_by);
    const bool held = is_clearly_above_zero({-e.mean, e.standard_error});
    const bool broken = is_clearly_above_zero(e);
    out.verdict = worse(out.verdict,
                        broken ? ZoneVerdict::missed : (held ? ZoneVerdict::met : ZoneVerdict::undetermined));
    const double missing = unit > 0.0 ? e.mean / (bound.value * unit) : 1.0;
    if (!(missing > out.missing)) continue;
    out.missing = missing;
    out.place = cells.place_text(cells.cells()[c]);
    // The ratio's error by that of the difference: the reference's own is in it.
    out.found = {unit > 0.0 ? light.mean(c).mean / unit : 0.0, unit > 0.0 ? e.standard_error / unit : 0.0};
  }
  return out;
}

}  // namespace

std::string_view to_string(ZoneVerdict verdict) {
  switch (verdict) {
    case ZoneVerdict::met:
      return "met";
    case ZoneVerdict::missed:
      return "missed";
    case ZoneVerdict::undetermined:
      return "not determined";
  }
  return "";
}

ZoneVerdict ZoneCheck::verdict() const {
  ZoneVerdict out = ZoneVerdict::met;
  for (const ZoneBoundCheck& b : bounds) out = worse(out, b.verdict);
  return out;
}

std::vector<ZoneCheck> check_zones(const ZoneCells& cells, std::span<const BoxSums> replicates,
                                   double source_flux) {
  const ZoneLight light(cells, replicates, source_flux, &BoxSums::zones);
  const ZoneLight direct(cells, replicates, source_flux, &BoxSums::zones_direct);
  std::vector<ZoneCheck> out;
  for (std::size_t z = 0; z < cells.zones().size(); ++z) {
    const TargetZone& zone = cells.zones()[z];
    ZoneCheck check{zone.name, cells.first(z + 1) - cells.first(z), zone.cell, cells.on_plane()};
    check.min = light.mean(light.darkest(z));
    check.max = light.mean(light.brightest(z));
    check.mean = mean_estimate(light.over(z));
    for (const ZoneBound& bound : zone.bounds) {
      check.bounds.push_back(check_bound(cells, light, z, bound));
      check_direct(direct, z, bound, check.bounds.back());
    }
    out.push_back(std::move(check));
  }
  return out;
}

double missing_in_zones(std::span<const ZoneCheck> zones) {
  double sum = 0.0;
  for (const ZoneCheck& zone : zones) {
    double max = 0.0;
    for (const ZoneBoundCheck& b : zone.bounds) max = std::max(max, b.missing);
    sum += max;
  }
  return sum;
}

bool any_undetermined(std::span<const ZoneCheck> zones) {
  return std::any_of(zones.begin(), zones.end(),
                     [](const ZoneCheck& z) { return z.verdict() == ZoneVerdict::undetermined; });
}

std::string zones_headline(std::span<const ZoneCheck> zones) {
  const auto met = std::count_if(zones.begin(), zones.end(),
                                 [](const ZoneCheck& z) { return z.verdict() == ZoneVerdict::met; });
  std::string text = fmt::format("{} of {} zones met", met, zones.size());
  for (const ZoneVerdict verdict : {ZoneVerdict::missed, ZoneVerdict::undetermined}) {
    std::string names;
    for (const ZoneCheck& zone : zones) {
      for (const ZoneBoundCheck& b : zone.bounds) {
        if (b.verdict != verdict) continue;
        names += fmt::format("{}{} ({}: {} found at {}, {:.5g} allowed)", names.empty() ? "" : ", ",
                             zone.name, b.key, estimate_text(b.found), b.place, b.allowed);
      }
    }
    if (!names.empty()) text += fmt::format("; {}: {}", to_string(verdict), names);
  }
  return text;
}

}  // namespace lucerna
