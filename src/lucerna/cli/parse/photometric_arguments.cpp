// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/photometric_arguments.h"

#include "lucerna/core/io/file.h"

namespace lucerna::cli {

void PhotometricArguments::add_read(Command& command) {
  command.option("--ies-turn", ies_turn, "IES files: 0: H = C, sizes swapped; 90: H = C - 90, sizes kept",
                 {"0", "90"});
  command.option("--isym3", isym3,
                 "Order of the planes in EULUMDAT files of symmetry 3: standard or reversed",
                 {"standard", "reversed"});
}

PhotometricReadOptions PhotometricArguments::read_options(bool strict) const {
  return {.strict = strict,
          .isym3 = isym3 == "reversed" ? Isym3Order::reversed : Isym3Order::standard,
          .ies_turn = ies_turn == "90" ? IesTurn::minus_90 : IesTurn::none};
}

PhotometricWriteOptions PhotometricArguments::write_options() const {
  return {.ies_turn = ies_turn == "90" ? IesTurn::minus_90 : IesTurn::none};
}

std::optional<PhotometricFormat> photometric_format_for(const std::string& path, const std::string& to) {
  if (to == "ies-2002") return PhotometricFormat::ies_2002;
  if (to == "ies-2019") return PhotometricFormat::ies_2019;
  if (to == "ldt") return PhotometricFormat::ldt;
  if (!to.empty()) return std::nullopt;
  const std::string ending = lower_ending(path);
  if (ending == ".ies") return PhotometricFormat::ies_2019;
  if (ending == ".ldt") return PhotometricFormat::ldt;
  return std::nullopt;
}

}  // namespace lucerna::cli
