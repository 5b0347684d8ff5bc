// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source_model.h"

#include <array>
#include <cstring>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/source/file/nfl.h"
#include "lucerna/source/model/model_etendue.h"

namespace lucerna {

std::unique_ptr<SourceModel> load_source_model(const std::filesystem::path& path) {
  return source_model_from_bytes(read_file(path, kNflLargestFile), path.string());
}

std::unique_ptr<SourceModel> source_model_from_bytes(std::string_view bytes, const std::string& name) {
  const NflFile file = decode_nfl(bytes, name);
  if (file.method == kClusterMethod) return ClusterModel::from_nfl(file, name);
  if (file.method == kAdaptiveMethod) return AdaptiveModel::from_nfl(file, name);
  throw_input_error(name, "byte 12", "method '{}' is not known; expected '{}' or '{}'",
                    printable_tag(file.method), printable_tag(kClusterMethod),
                    printable_tag(kAdaptiveMethod));
}

std::uint64_t save_source_model(const std::filesystem::path& path, const SourceModel& model) {
  const std::string bytes = source_model_bytes(model);
  write_file(path, bytes);
  return bytes.size();
}

std::string source_model_bytes(const SourceModel& model) { return encode_nfl(model.to_nfl()); }

std::vector<double> etendue_mm2sr(const SourceModel& model, std::span<const double> shares,
                                  std::uint64_t rays, std::uint64_t seed) {
  for (const double share : shares) {
    if (!(share >= 0.0 && share <= 1.0))
      throw InputError(fmt::format("share of the flux: found {}, expected 0 to 1", share),
                       ErrorCause::out_of_range);
  }
  const EtendueCurve curve = etendue_curve(model, rays, seed);
  std::vector<double> out;
  for (const double share : shares) out.push_back(curve.degenerate() ? 0.0 : curve.at(share));
  return out;
}

bool is_source_model(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return false;
  const InputFile file(path);
  std::array<std::byte, kNflMagic.size()> start{};
  if (file.size() < start.size()) return false;
  file.read_at(0, start);
  return std::memcmp(start.data(), kNflMagic.data(), start.size()) == 0;
}

}  // namespace lucerna
