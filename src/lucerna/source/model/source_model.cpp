// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source_model.h"

#include <array>
#include <cstring>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/source/file/nfl.h"

namespace lucerna {

std::unique_ptr<SourceModel> load_source_model(const std::filesystem::path& path) {
  const std::string bytes = read_file(path, kNflLargestFile);
  const NflFile file = decode_nfl(bytes, path.string());
  if (file.method == kClusterMethod) return ClusterModel::from_nfl(file, path.string());
  if (file.method == kAdaptiveMethod) return AdaptiveModel::from_nfl(file, path.string());
  throw_input_error(path.string(), "byte 12", "method '{}' is not known; expected '{}' or '{}'",
                    printable_tag(file.method), printable_tag(kClusterMethod),
                    printable_tag(kAdaptiveMethod));
}

std::uint64_t save_source_model(const std::filesystem::path& path, const SourceModel& model) {
  const std::string bytes = encode_nfl(model.to_nfl());
  write_file(path, bytes);
  return bytes.size();
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
