// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "lucerna/project.h"

namespace lucerna {

/// The same with all names made absolute, from the folder of the project file `path`.
ProjectMemory absolute_names(const ProjectMemory& memory, const std::filesystem::path& path);

/// What is in memory under the name of `file`, relative to the working folder; null if nothing is.
template <class Object>
std::shared_ptr<const Object> in_memory(const std::map<std::string, std::shared_ptr<const Object>>& objects,
                                        const std::filesystem::path& file) {
  const auto found = objects.find(std::filesystem::absolute(file).lexically_normal().string());
  return found == objects.end() ? nullptr : found->second;
}

}  // namespace lucerna
