// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "lucerna/cli/parse/command.h"
#include "lucerna/photometric_file.h"

namespace lucerna::cli {

/// The options that say how IES and EULUMDAT files are meant: --ies-turn and --isym3.
struct PhotometricArguments {
  std::string ies_turn = "0", isym3 = "standard";

  void add_read(Command& command);
  PhotometricReadOptions read_options(bool strict) const;
  PhotometricWriteOptions write_options() const;
};

/// The photometric format that `--to` names or the ending says (.ies is ies-2019, .ldt); nothing if neither
/// does.
std::optional<PhotometricFormat> photometric_format_for(const std::string& path, const std::string& to);

}  // namespace lucerna::cli
