// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "lucerna/core/parallel/peers.h"
#include "lucerna/progress.h"
#include "lucerna/source_model.h"

namespace lucerna {

/// `compress` of files (source_model.h) with peers, each of which reads a part of every file; all of them
/// make the model, of the same bits for any number of them. Collective; an InputError is thrown by all. Null:
/// without peers.
CompressedFiles compress_files(const std::vector<std::filesystem::path>& files,
                               const CompressOptions& options, Peers* peers, Progress& progress);

}  // namespace lucerna
