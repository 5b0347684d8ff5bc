// SPDX-License-Identifier: Apache-2.0
#include "lucerna/glass_catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "lucerna/core/io/diagnostic_text.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/io/spelling.h"
#include "lucerna/core/io/text.h"
#include "lucerna/optics/materials/agf_formulas.h"
#include "lucerna/optics/materials/dispersion.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxCatalogueBytes = std::uint64_t{64} << 20;
constexpr double kDLineNm = 587.5618;
/// Catalogues state five decimals or more, and old ones differ in the fourth.
constexpr double kIndexTolerance = 1e-3;

using Words = std::vector<std::string_view>;

std::string upper(std::string_view text) {
  std::string out;
  for (const char c : text) out += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return out;
}

/// Calls `each(line number, words)` for every line that is not empty, until it returns false.
template <class Each>
void for_each_line(const std::filesystem::path& path, const Each& each) {
  const std::string text = decoded_text(read_file(path, kMaxCatalogueBytes));
  std::size_t number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    const Words words = blank_separated(line);
    if (!words.empty() && !each(number, words)) return;
  }
}

bool begins_glass(const Words& words) { return words.front() == "NM"; }

/// Takes the records of one glass, line by line.
class GlassReader {
 public:
  explicit GlassReader(std::string file) : file_(std::move(file)) {}

  void add(std::size_t line, const Words& words) {
    line_ = line;
    const std::string_view record = words.front();
    const bool goes_on = last_was_cd_ && number_from(record).has_value();
    if (goes_on) return add_numbers(glass_.coefficients, words);  // some makers break the line
    const std::span rest = std::span(words).subspan(1);
    last_was_cd_ = record == "CD";
    if (record == "NM") add_name(rest);
    if (record == "CD") add_numbers(glass_.coefficients, rest);
    if (record == "LD") add_range(rest);
    if (record == "IT" && !rest.empty()) add_transmittance(rest);
  }

  /// The whole glass, after its last line.
  CatalogueGlass take() {
    const std::size_t needed = agf_coefficients(glass_.formula);
    if (glass_.coefficients.size() < needed) {
      fail("found {} coefficients (CD) of '{}', expected {} for formula {}", glass_.coefficients.size(),
           glass_.name, needed, glass_.formula);
    }
    if (glass_.max_nm == 0.0) fail("'{}' has no range of wavelengths (LD)", glass_.name);
    check_stated_index();
    sort_transmittance();
    return std::move(glass_);
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, line_place(line_), text, std::forward<Args>(args)...);
  }

  double number(std::string_view word) const {
    const auto value = number_from(word);
    if (!value) fail("found '{}', expected a number", word.substr(0, 40));
    return *value;
  }

  void add_numbers(std::vector<double>& to, std::span<const std::string_view> words) const {
    for (const std::string_view word : words) to.push_back(number(word));
  }

  void add_name(std::span<const std::string_view> words) {
    if (words.size() < 2) fail("found {} words after NM, expected a name and a formula", words.size());
    glass_.name = words[0];
    const double formula = number(words[1]);
    if (formula != std::floor(formula) || formula < 1 || formula > kAgfFormulas) {
      fail("found formula {}, expected 1 to {}", words[1].substr(0, 40), kAgfFormulas);
    }
    glass_.formula = static_cast<int>(formula);
    if (words.size() >= 4) glass_.stated_index_d = number_from(words[3]).value_or(0.0);
  }

  void add_range(std::span<const std::string_view> words) {
    if (words.size() < 2) fail("found {} numbers after LD, expected 2", words.size());
    const double from_um = number(words[0]), to_um = number(words[1]);
    if (!(from_um > 0.0 && to_um > from_um)) {
      fail("found wavelengths from {} to {} um, expected from a smaller to a larger", from_um, to_um);
    }
    glass_.min_nm = 1e3 * from_um;
    glass_.max_nm = 1e3 * to_um;
  }

  void add_transmittance(std::span<const std::string_view> words) {
    if (words.size() < 3) fail("found {} numbers after IT, expected 3", words.size());
    const InternalTransmittance row{1e3 * number(words[0]), number(words[1]), number(words[2])};
    if (!(row.wavelength_nm > 0.0)) fail("found a wavelength of {} um, expected > 0", words[0]);
    if (!(row.transmittance >= 0.0 && row.transmittance <= 1.0))
      fail("found a transmittance of {}, expected 0 to 1", row.transmittance);
    if (!(row.thickness_mm > 0.0)) fail("found a thickness of {} mm, expected > 0", row.thickness_mm);
    glass_.transmittance.push_back(row);
  }

  void check_stated_index() const {
    const double stated = glass_.stated_index_d;
    if (!(stated >= 1.0) || !(glass_.min_nm <= kDLineNm && kDLineNm <= glass_.max_nm)) return;
    const double found = agf_index(glass_.formula, glass_.coefficients, 1e-3 * kDLineNm);
    if (!(std::abs(found - stated) <= kIndexTolerance)) {
      fail("'{}' has the index {:.6f} at {} nm by its formula {}, but {} is stated in its line NM",
           glass_.name, found, kDLineNm, glass_.formula, stated);
    }
  }

  void sort_transmittance() {
    auto& rows = glass_.transmittance;
    std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
      return a.wavelength_nm != b.wavelength_nm ? a.wavelength_nm < b.wavelength_nm
                                                : a.thickness_mm > b.thickness_mm;
    });
    const auto same = [](const auto& a, const auto& b) { return a.wavelength_nm == b.wavelength_nm; };
    rows.erase(std::unique(rows.begin(), rows.end(), same), rows.end());
  }

  std::string file_;
  std::size_t line_ = 0;
  bool last_was_cd_ = false;
  CatalogueGlass glass_;
};

[[noreturn]] void fail_without_glass(const std::filesystem::path& path) {
  throw_input_error(path.string(), "", "no glass was found, expected lines that begin with NM");
}

double per_mm(const InternalTransmittance& row) {
  return std::pow(row.transmittance, 1.0 / row.thickness_mm);
}

void check_range(const CatalogueGlass& glass, const char* what, double nm, double min_nm, double max_nm) {
  if (nm >= min_nm && nm <= max_nm) return;
  throw InputError(fmt::format("{} of glass '{}': found {} nm, expected {:g} to {:g} nm", what, glass.name,
                               nm, min_nm, max_nm),
                   ErrorCause::out_of_range);
}

}  // namespace

std::vector<std::string> glass_names(const std::filesystem::path& catalogue) {
  std::vector<std::string> names;
  for_each_line(catalogue, [&](std::size_t, const Words& words) {
    if (begins_glass(words) && words.size() > 1) names.emplace_back(words[1]);
    return true;
  });
  if (names.empty()) fail_without_glass(catalogue);
  return names;
}

CatalogueGlass read_glass(const std::filesystem::path& catalogue, std::string_view name) {
  GlassReader reader(catalogue.string());
  const std::string wanted = upper(name);
  bool found = false;
  WordSet known;
  for_each_line(catalogue, [&](std::size_t line, const Words& words) {
    if (begins_glass(words)) {
      if (found) return false;
      if (words.size() > 1) known.emplace(words[1]);
      found = words.size() > 1 && upper(words[1]) == wanted;
    }
    if (found) reader.add(line, words);
    return true;
  });
  if (found) return reader.take();
  if (known.empty()) fail_without_glass(catalogue);
  throw InputError(fmt::format("{}: there is no glass '{}'; the nearest of {} is '{}'", catalogue.string(),
                               name, known.size(), nearest_word(wanted, known)));
}

double glass_index(const CatalogueGlass& glass, double wavelength_nm) {
  check_range(glass, "formula", wavelength_nm, glass.min_nm, glass.max_nm);
  const double n = agf_index(glass.formula, glass.coefficients, 1e-3 * wavelength_nm);
  if (!(n > 0.0) || !std::isfinite(n)) {
    throw InputError(fmt::format("formula {} of glass '{}' gives no index at {} nm", glass.formula,
                                 glass.name, wavelength_nm));
  }
  return n;
}

namespace {

/// The share of 1 mm, linear between rows, of which there is at least one; `wavelength_nm` within them.
double transmittance_of_1_mm(const std::vector<InternalTransmittance>& rows, double wavelength_nm) {
  const auto b = std::ranges::lower_bound(rows, wavelength_nm, {}, &InternalTransmittance::wavelength_nm);
  if (!(b->wavelength_nm > wavelength_nm)) return per_mm(*b);
  const auto a = b - 1;
  return std::lerp(per_mm(*a), per_mm(*b),
                   (wavelength_nm - a->wavelength_nm) / (b->wavelength_nm - a->wavelength_nm));
}

/// The longest run of samples that a medium may have, as [first, last).
std::pair<std::size_t, std::size_t> usable_samples(const std::vector<double>& index) {
  std::pair<std::size_t, std::size_t> longest{0, 0};
  for (std::size_t first = 0; first < index.size(); ++first) {
    std::size_t last = first;
    while (last < index.size() && index[last] >= 1.0 && index[last] <= 4.0) ++last;
    if (last - first > longest.second - longest.first) longest = {first, last};
    first = last;
  }
  return longest;
}

}  // namespace

Dispersion dispersion(const CatalogueGlass& glass) {
  constexpr double kDark = 1e-30;
  std::vector<double> index = each_nanometre(glass.min_nm, glass.max_nm, [&](double nm) {
    return agf_index(glass.formula, glass.coefficients, 1e-3 * nm);
  });
  const auto [first, last] = usable_samples(index);
  if (last < first + 2) {
    throw InputError(fmt::format("formula {} of glass '{}' gives no index of 1 to 4 within {} to {} nm",
                                 glass.formula, glass.name, glass.min_nm, glass.max_nm));
  }
  const double step_nm = (glass.max_nm - glass.min_nm) / static_cast<double>(index.size() - 1);
  const double min_nm = glass.min_nm + step_nm * static_cast<double>(first);
  const double max_nm = glass.min_nm + step_nm * static_cast<double>(last - 1);
  index = {index.begin() + static_cast<std::ptrdiff_t>(first),
           index.begin() + static_cast<std::ptrdiff_t>(last)};
  const auto& rows = glass.transmittance;
  std::vector<double> absorption_per_mm;
  for (std::size_t i = 0; i < index.size() && !rows.empty(); ++i) {
    const double within = std::clamp(min_nm + step_nm * static_cast<double>(i), rows.front().wavelength_nm,
                                     rows.back().wavelength_nm);
    absorption_per_mm.push_back(
        std::max(0.0, -std::log(std::max(kDark, transmittance_of_1_mm(rows, within)))));
  }
  return {min_nm, max_nm, std::move(index), std::move(absorption_per_mm)};
}

double glass_absorption_per_mm(const CatalogueGlass& glass, double wavelength_nm) {
  const auto& rows = glass.transmittance;
  if (rows.empty()) return 0.0;
  check_range(glass, "transmittance", wavelength_nm, rows.front().wavelength_nm, rows.back().wavelength_nm);
  const double passes = transmittance_of_1_mm(rows, wavelength_nm);
  if (passes == 0.0) {
    throw InputError(fmt::format("glass '{}' lets no light of {} nm through", glass.name, wavelength_nm),
                     ErrorCause::out_of_range);
  }
  return std::max(0.0, -std::log(passes));
}

}  // namespace lucerna
