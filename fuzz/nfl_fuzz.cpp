// SPDX-License-Identifier: Apache-2.0
// Any bytes as a model file: a whole file, and, since the checksum would stop nearly every such try at the
// door, sections as they are behind it. Decoders return a model that draws finite rays, or throw InputError.
// Input: a file that begins with the magic; else one byte (0 clusters, 1 adaptive) and sections of 4 bytes
// tag, 3 bytes length, bytes.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "lucerna/core/io/error.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/source/file/nfl.h"

namespace {

lucerna::NflFile sections_of(std::string_view bytes) {
  lucerna::NflFile file;
  file.method = bytes[0] == 0 ? lucerna::kClusterMethod : lucerna::kAdaptiveMethod;
  file.flux = 100.0;
  bytes.remove_prefix(1);
  while (bytes.size() >= 7) {
    const lucerna::NflTag tag{bytes[0], bytes[1], bytes[2], bytes[3]};
    std::size_t length = 0;
    for (std::size_t i = 4; i < 7; ++i) length = length << 8 | static_cast<std::uint8_t>(bytes[i]);
    bytes.remove_prefix(7);
    file.add(tag, std::string(bytes.substr(0, length)));
    bytes.remove_prefix(std::min(length, bytes.size()));
  }
  return file;
}

std::unique_ptr<lucerna::SourceModel> model_of(const lucerna::NflFile& file) {
  if (file.method == lucerna::kClusterMethod) return lucerna::ClusterModel::from_nfl(file, "fuzz");
  if (file.method == lucerna::kAdaptiveMethod) return lucerna::AdaptiveModel::from_nfl(file, "fuzz");
  throw lucerna::InputError("fuzz: another method");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const bool whole = bytes.starts_with(lucerna::kNflMagic);
    const auto model = model_of(whole ? lucerna::decode_nfl(bytes, "fuzz") : sections_of(bytes));
    lucerna::RayBlock rays;
    rays.resize(16, 0);
    model->emit(lucerna::Sequence(lucerna::SequenceKind::random, 1), 0, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!is_finite(rays.origin_mm(i)) || std::isnan(rays.kx[i])) std::abort();
    }
  } catch (const lucerna::InputError&) {
    // What bad input is meant to do.
  }
  return 0;
}
