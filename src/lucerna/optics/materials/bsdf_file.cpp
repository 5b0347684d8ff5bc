// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "lucerna/bsdf.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/io/text.h"
#include "lucerna/optics/materials/bsdf_lighttools.h"
#include "lucerna/optics/materials/bsdf_words.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxBsdfBytes = std::uint64_t{64} << 20;
/// Files round what they state.
constexpr double kAngleTolerance_deg = 0.01;

/// A file of Zemax.
class BsdfReader {
 public:
  explicit BsdfReader(BsdfWords words) : words_(std::move(words)) {}

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
    if (!words_.at_end()) {
      const std::string_view word = words_.next("the end");
      words_.fail("found '{}' after the last value", words_.shown(word));
    }
    return std::move(table_);
  }

 private:
  bool begins_data() {
    if (words_.at_end()) words_.fail("the file ends in its header, expected DataBegin");
    const std::string_view word = words_.peek();
    return word == "Monochrome" || word == "DataBegin" || word.starts_with("Tristimulus");
  }

  void read_header_line() {
    const std::string_view key = words_.next("a line of the header");
    if (key == "Source") {
      words_.next("what the source is");
    } else if (key == "Symmetry") {
      read_symmetry();
    } else if (key == "SpectralContent") {
      read_content();
    } else if (key == "ScatterType") {
      read_type();
    } else if (key == "SampleRotation") {
      if (words_.angles("SampleRotation", -360.0, 360.0).size() > 1)
        words_.refuse("several rotations of the sample, expected one");
    } else if (key == "AngleOfIncidence") {
      table_.incidence_deg = words_.angles("AngleOfIncidence", 0.0, 90.0);
    } else if (key == "ScatterAzimuth") {
      table_.azimuth_deg = words_.angles("ScatterAzimuth", 0.0, 360.0);
    } else if (key == "ScatterRadial") {
      table_.radial_deg = words_.angles("ScatterRadial", 0.0, 180.0);
    } else {
      words_.fail("found '{}', expected a key of the header", words_.shown(key));
    }
  }

  void read_symmetry() {
    const std::string_view word = words_.next("a symmetry");
    if (word != "PlaneSymmetrical" && word != "Asymmetrical" && word != "ASymmetrical")
      words_.fail("found symmetry '{}', expected PlaneSymmetrical or Asymmetrical", words_.shown(word));
    is_symmetrical_ = word == "PlaneSymmetrical";
  }

  void read_content() {
    const std::string_view word = words_.next("Monochrome or XYZ");
    if (word != "Monochrome" && word != "XYZ")
      words_.fail("found '{}', expected Monochrome or XYZ", words_.shown(word));
    is_tristimulus_ = word == "XYZ";
  }

  void read_type() {
    const std::string_view word = words_.next("BRDF or BTDF");
    if (word == "BTDF") words_.refuse("light that goes through (BTDF), expected a BRDF");
    if (word != "BRDF") words_.fail("found '{}', expected BRDF", words_.shown(word));
  }

  void check_header() {
    const auto need = [&](const std::vector<double>& found, const char* key, std::size_t least) {
      if (found.size() < least)
        words_.fail("found {} angles of {}, expected {} or more", found.size(), key, least);
    };
    need(table_.incidence_deg, "AngleOfIncidence", 1);
    need(table_.azimuth_deg, "ScatterAzimuth", 1);
    need(table_.radial_deg, "ScatterRadial", 2);
    if (table_.incidence_deg.back() >= 90.0) words_.fail("found an incidence of 90 degrees, expected less");
    if (table_.radial_deg.front() != 0.0 || table_.azimuth_deg.front() != 0.0)
      words_.fail("found angles of scatter that begin at {} and {}, expected 0", table_.azimuth_deg.front(),
                  table_.radial_deg.front());
    check_azimuths();
    const double values = static_cast<double>(table_.incidence_deg.size()) * static_cast<double>(azimuths_) *
                          static_cast<double>(table_.radial_deg.size());
    if (values > static_cast<double>(words_.count()))
      words_.fail("the file has {} words, expected {} values", words_.count(), values);
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
      words_.fail("found azimuths to {} degrees, expected them to go to {}", azimuth.back(), end);
    } else {
      azimuth.push_back(360.0);
    }
  }

  void read_block(std::string_view name) {
    table_.brdf.clear();
    table_.total.clear();
    words_.require(name);
    words_.require("DataBegin");
    for (std::size_t i = 0; i < table_.incidence_deg.size(); ++i) {
      words_.require("TIS");
      table_.total.push_back(words_.total());
      read_values();
    }
    words_.require("DataEnd");
  }

  void read_values() {
    auto& brdf = table_.brdf;
    const std::size_t first = brdf.size(), radials = table_.radial_deg.size();
    words_.values(azimuths_ * radials, brdf);
    if (azimuths_ == table_.azimuth_deg.size()) return;
    // What the last azimuth was added for begins where the first does.
    brdf.insert(brdf.end(), radials, 0.0);
    std::copy_n(brdf.begin() + static_cast<std::ptrdiff_t>(first), radials,
                brdf.end() - static_cast<std::ptrdiff_t>(radials));
  }

  BsdfWords words_;
  bool is_symmetrical_ = false, is_tristimulus_ = false;
  /// In the file; the table may have one more.
  std::size_t azimuths_ = 0;
  BsdfTable table_;
};

/// LightTools states an incidence in each block; Zemax lists them in the header, after keys that LightTools
/// has not. A file that ends before its first block is told by those.
bool is_of_lighttools(const BsdfWords& words) {
  if (words.have("AOI")) return true;
  return !words.have("Source") && !words.have("SampleRotation") && !words.have("AngleOfIncidence");
}

}  // namespace

BsdfTable parse_bsdf(std::string_view text, const std::string& name, double wavelength_nm) {
  BsdfWords words(text, name);
  return is_of_lighttools(words) ? read_lighttools_bsdf(words, wavelength_nm)
                                 : BsdfReader(std::move(words)).read();
}

BsdfTable read_bsdf(const std::filesystem::path& path, double wavelength_nm) {
  const std::string text = decoded_text(read_file(path, kMaxBsdfBytes));
  return parse_bsdf(text, path.string(), wavelength_nm);
}

}  // namespace lucerna
