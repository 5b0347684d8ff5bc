// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "lucerna/bsdf.h"
#include "lucerna/core/io/diagnostic_text.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/io/text.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxBsdfBytes = std::uint64_t{64} << 20;
constexpr double kMaxAngles = 10'000.0, kMaxBrdf = 1e12;
/// Files round what they state.
constexpr double kAboveOne = 1.01, kAngleTolerance_deg = 0.01;

struct Word {
  std::string_view text;
  std::size_t line = 0;
};

/// All words but those of comments.
std::vector<Word> bsdf_words(std::string_view text) {
  std::vector<Word> out;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    if (trimmed(line).starts_with('#')) continue;
    for (const std::string_view word : blank_separated(line)) out.push_back({word, number});
  }
  return out;
}

class BsdfReader {
 public:
  BsdfReader(std::string_view text, std::string file) : file_(std::move(file)), words_(bsdf_words(text)) {}

  BsdfTable read() {
    while (!begins_data()) read_header_line();
    check_header();
    if (is_tristimulus_) {
      read_block("TristimulusX");
      read_block("TristimulusY");
      std::pair y{std::move(table_.brdf), std::move(table_.total)};
      read_block("TristimulusZ");
      std::tie(table_.brdf, table_.total) = std::move(y);
    } else {
      read_block("Monochrome");
    }
    if (at_ < words_.size()) fail("found '{}' after the last value", shown(words_[at_].text));
    return std::move(table_);
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, line_place(line_), text, std::forward<Args>(args)...);
  }
  template <class... Args>
  [[noreturn]] void refuse(fmt::format_string<Args...> text, Args&&... args) const {
    throw InputError(
        fmt::format("{}: {}: {}", file_, line_place(line_), fmt::format(text, std::forward<Args>(args)...)),
        ErrorCause::unsupported);
  }
  static std::string_view shown(std::string_view word) { return word.substr(0, 40); }

  std::string_view next(const char* expected) {
    if (at_ == words_.size()) fail("the file ends, expected {}", expected);
    line_ = words_[at_].line;
    return words_[at_++].text;
  }

  double number(const char* expected) {
    const std::string_view word = next(expected);
    const auto value = number_from(word);
    if (!value) fail("found '{}', expected {}", shown(word), expected);
    return *value;
  }

  void require(std::string_view word) {
    const std::string expected(word);
    if (const std::string_view found = next(expected.c_str()); found != word)
      fail("found '{}', expected {}", shown(found), word);
  }

  bool begins_data() {
    if (at_ == words_.size()) fail("the file ends in its header, expected DataBegin");
    const std::string_view word = words_[at_].text;
    return word == "Monochrome" || word == "DataBegin" || word.starts_with("Tristimulus");
  }

  void read_header_line() {
    const std::string_view key = next("a line of the header");
    if (key == "Source") {
      next("what the source is");
    } else if (key == "Symmetry") {
      read_symmetry();
    } else if (key == "SpectralContent") {
      read_content();
    } else if (key == "ScatterType") {
      read_type();
    } else if (key == "SampleRotation") {
      if (angles("SampleRotation", -360.0, 360.0).size() > 1)
        refuse("several rotations of the sample, expected one");
    } else if (key == "AngleOfIncidence") {
      table_.incidence_deg = angles("AngleOfIncidence", 0.0, 90.0);
    } else if (key == "ScatterAzimuth") {
      table_.azimuth_deg = angles("ScatterAzimuth", 0.0, 360.0);
    } else if (key == "ScatterRadial") {
      table_.radial_deg = angles("ScatterRadial", 0.0, 180.0);
    } else {
      fail("found '{}', expected a key of the header", shown(key));
    }
  }

  void read_symmetry() {
    const std::string_view word = next("a symmetry");
    if (word == "Asymmetric") refuse("the symmetry of LightTools's files, expected one of Zemax's");
    if (word != "PlaneSymmetrical" && word != "Asymmetrical" && word != "ASymmetrical")
      fail("found symmetry '{}', expected PlaneSymmetrical or Asymmetrical", shown(word));
    is_symmetrical_ = word == "PlaneSymmetrical";
  }

  void read_content() {
    const std::string_view word = next("Monochrome or XYZ");
    if (word != "Monochrome" && word != "XYZ") fail("found '{}', expected Monochrome or XYZ", shown(word));
    is_tristimulus_ = word == "XYZ";
  }

  void read_type() {
    const std::string_view word = next("BRDF or BTDF");
    if (word == "BTDF") refuse("light that goes through (BTDF), expected a BRDF");
    if (word != "BRDF") fail("found '{}', expected BRDF", shown(word));
  }

  std::vector<double> angles(const char* what, double min, double max) {
    const double count = number("the number of angles");
    if (!(count >= 1.0 && count <= kMaxAngles && count == std::floor(count)))
      fail("found {} angles of {}, expected 1 to {}", count, what, kMaxAngles);
    std::vector<double> out;
    for (int i = 0; i < static_cast<int>(count); ++i) {
      out.push_back(number("an angle in degrees"));
      if (!(out.back() >= min && out.back() <= max))
        fail("found an angle of {} degrees for {}, expected {} to {}", out.back(), what, min, max);
      if (i > 0 && !(out.back() > out[out.size() - 2]))
        fail("found an angle of {} degrees after {} for {}, expected them to ascend", out.back(),
             out[out.size() - 2], what);
    }
    return out;
  }

  void check_header() {
    line_ = words_[at_].line;
    const auto need = [&](const std::vector<double>& found, const char* key, std::size_t least) {
      if (found.size() < least) fail("found {} angles of {}, expected {} or more", found.size(), key, least);
    };
    need(table_.incidence_deg, "AngleOfIncidence", 1);
    need(table_.azimuth_deg, "ScatterAzimuth", 1);
    need(table_.radial_deg, "ScatterRadial", 2);
    if (table_.incidence_deg.back() >= 90.0) fail("found an incidence of 90 degrees, expected less");
    if (table_.radial_deg.front() != 0.0 || table_.azimuth_deg.front() != 0.0)
      fail("found angles of scatter that begin at {} and {}, expected 0", table_.azimuth_deg.front(),
           table_.radial_deg.front());
    check_azimuths();
    const double values = static_cast<double>(table_.incidence_deg.size()) * static_cast<double>(azimuths_) *
                          static_cast<double>(table_.radial_deg.size());
    if (values > static_cast<double>(words_.size()))
      fail("the file has {} words, expected {} values", words_.size(), values);
  }

  /// Makes the azimuths go to 180 or 360 degrees, which rows are added for.
  void check_azimuths() {
    auto& azimuth = table_.azimuth_deg;
    azimuths_ = azimuth.size();
    if (azimuths_ == 1) {  // the same all around
      azimuth.push_back(180.0);
      return;
    }
    const double end = is_symmetrical_ ? 180.0 : 360.0;
    if (std::abs(azimuth.back() - end) <= kAngleTolerance_deg ||
        std::abs(azimuth.back() - 360.0) <= kAngleTolerance_deg) {
      azimuth.back() = std::abs(azimuth.back() - 360.0) <= kAngleTolerance_deg ? 360.0 : end;
    } else if (is_symmetrical_ || azimuth.back() < 180.0) {
      fail("found azimuths to {} degrees, expected them to go to {}", azimuth.back(), end);
    } else {
      azimuth.push_back(360.0);
    }
  }

  void read_block(std::string_view name) {
    table_.brdf.clear();
    table_.total.clear();
    require(name);
    require("DataBegin");
    for (std::size_t i = 0; i < table_.incidence_deg.size(); ++i) {
      require("TIS");
      const double total = number("the total of an incidence (TIS)");
      if (!(total > 0.0 && total <= kAboveOne))
        fail("found a total (TIS) of {}, expected more than 0 to 1", total);
      table_.total.push_back(std::min(total, 1.0));
      read_values();
    }
    require("DataEnd");
  }

  void read_values() {
    auto& brdf = table_.brdf;
    const std::size_t first = brdf.size(), radials = table_.radial_deg.size();
    double sum = 0.0;
    for (std::size_t k = 0; k < azimuths_ * radials; ++k) {
      brdf.push_back(number("a value of the BRDF"));
      if (!(brdf.back() >= 0.0 && brdf.back() <= kMaxBrdf))
        fail("found a BRDF of {}, expected 0 to {}", brdf.back(), kMaxBrdf);
      sum += brdf.back();
    }
    if (!(sum > 0.0)) fail("found no value above 0 for an incidence");
    if (azimuths_ == table_.azimuth_deg.size()) return;
    // What the last azimuth was added for begins where the first does.
    brdf.insert(brdf.end(), radials, 0.0);
    std::copy_n(brdf.begin() + static_cast<std::ptrdiff_t>(first), radials,
                brdf.end() - static_cast<std::ptrdiff_t>(radials));
  }

  std::string file_;
  std::vector<Word> words_;
  std::size_t at_ = 0, line_ = 0;
  bool is_symmetrical_ = false, is_tristimulus_ = false;
  /// In the file; the table may have one more.
  std::size_t azimuths_ = 0;
  BsdfTable table_;
};

}  // namespace

BsdfTable parse_bsdf(std::string_view text, const std::string& name) { return BsdfReader(text, name).read(); }

BsdfTable read_bsdf(const std::filesystem::path& path) {
  const std::string text = decoded_text(read_file(path, kMaxBsdfBytes));
  return parse_bsdf(text, path.string());
}

}  // namespace lucerna
