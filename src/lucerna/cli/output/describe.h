// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lucerna/cli/parse/session.h"
#include "lucerna/photometric_file.h"

namespace lucerna::cli {

/// What `info` has to say of one file: the JSON entry, the lines for people, and what was odd.
// A JSON value checks itself when moved. NOLINTNEXTLINE(bugprone-exception-escape)
struct Description {
  Json json;
  std::vector<std::string> lines;
  std::vector<std::string> warnings;
};

/// A ray file, read to its end.
Description describe_rays(const std::string& path, const std::string& format, Session& session);
/// A source model.
Description describe_model(const std::string& path);
/// Whether the name says that it is a catalogue of glasses (.agf).
bool is_glass_catalogue(const std::string& path);
/// A catalogue of glasses; what is wrong with one of them is a warning.
Description describe_catalogue(const std::string& path);
/// Whether the name says that it is a measured BRDF (.bsdf).
bool is_bsdf_file(const std::string& path);
/// A measured BRDF.
Description describe_bsdf(const std::string& path);
/// An IES or EULUMDAT file.
Description describe_photometry(const std::string& path, const PhotometricReadOptions& options);

/// A null for what is not there or not finite.
Json to_json(const std::optional<double>& value);
Json to_json(double value);

}  // namespace lucerna::cli
