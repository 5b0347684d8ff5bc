// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/materials/bsdf_lighttools.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna {

namespace {

/// Where the file has the direction that a mirror sends the light to.
constexpr double kMirrored_deg = 270.0;
/// Azimuths that are nearer than this are the same.
constexpr double kSame_deg = 0.01;

struct Header {
  bool is_symmetrical = false, is_tristimulus = false;
  std::vector<double> azimuth_deg, radial_deg;
  std::size_t azimuth_line = 0;
};

void check_radials(const std::vector<double>& radial_deg, const BsdfWords& words) {
  if (radial_deg.size() < 2) words.fail("found one radial angle, expected 2 or more");
  if (radial_deg.front() != 0.0)
    words.fail("found radial angles that begin at {}, expected 0", radial_deg.front());
}

Header read_header(BsdfWords& words) {
  Header out;
  for (std::string_view key; (key = words.next("a line of the header, or DataBegin")) != "DataBegin";) {
    if (key == "Symmetry") {
      const std::string_view word = words.next("a symmetry");
      if (word != "PlaneSymmetrical" && word != "Asymmetric")
        words.fail("found symmetry '{}', expected PlaneSymmetrical or Asymmetric", words.shown(word));
      out.is_symmetrical = word == "PlaneSymmetrical";
    } else if (key == "SpectralContent") {
      const std::string_view word = words.next("Monochrome or XYZ");
      if (word != "Monochrome" && word != "XYZ")
        words.fail("found '{}', expected Monochrome or XYZ", words.shown(word));
      out.is_tristimulus = word == "XYZ";
    } else if (key == "ScatterAzimuth") {
      out.azimuth_line = words.line();
      out.azimuth_deg = words.angles("ScatterAzimuth", -360.0, 360.0);
    } else if (key == "ScatterRadial") {
      out.radial_deg = words.angles("ScatterRadial", 0.0, 90.0);
      check_radials(out.radial_deg, words);
    } else {
      words.skip_line();  // names, comments
    }
  }
  if (out.azimuth_deg.empty()) words.fail("found no ScatterAzimuth before the data, expected one");
  if (out.radial_deg.empty()) words.fail("found no ScatterRadial before the data, expected one");
  return out;
}

/// What the keys before the values of a block say.
struct Block {
  std::optional<double> incidence_deg;
  double plane_deg = 0.0, wavelength_nm = 0.0, total = 0.0;
  std::string side = "Front", type = "BRDF", value = "TrisY";

  bool is_wanted() const { return side == "Front" && type == "BRDF" && value == "TrisY"; }
};

/// Reads on to the values of the next block; nothing where the data end.
std::optional<Block> next_block(BsdfWords& words) {
  Block out;
  const auto one_of = [&](std::initializer_list<std::string_view> known) {
    const std::string_view word = words.next("a word of a block");
    if (std::ranges::find(known, word) == known.end())
      words.fail("found '{}', expected {}", words.shown(word), *known.begin());
    return std::string(word);
  };
  for (;;) {
    const std::string_view key = words.next("a key of a block, or DataEnd");
    if (key == "DataEnd") return std::nullopt;
    if (key == "AOI") {
      out.incidence_deg = words.number("an angle of incidence");
    } else if (key == "POI") {
      out.plane_deg = words.number("the azimuth of the plane of incidence");
    } else if (key == "Wavelength") {
      out.wavelength_nm = words.number("a wavelength");
    } else if (key == "Side") {
      out.side = one_of({"Front", "Back"});
    } else if (key == "ScatterType") {
      out.type = one_of({"BRDF", "BTDF"});
    } else if (key == "TristimulusValue") {
      out.value = one_of({"TrisY", "TrisX", "TrisZ"});
    } else if (key == "TIS") {
      if (!out.incidence_deg) words.fail("found TIS, expected AOI before it");
      return out;
    } else {
      words.fail("found '{}', expected a key of a block", words.shown(key));
    }
  }
}

/// A column of the file at an azimuth of the table: between two of its own, where it has none there.
struct Column {
  double azimuth_deg = 0.0;
  std::size_t from = 0, to = 0;
  double share_of_to = 0.0;
};

/// From the mirrored direction on, in [0, 360).
double from_mirrored(double azimuth_deg) {
  const double a = std::fmod(azimuth_deg - kMirrored_deg + 1080.0, 360.0);
  return a > 360.0 - kSame_deg ? 0.0 : a;
}

/// The file's columns by azimuth from the mirrored direction, those that stand for the same once.
std::vector<Column> sorted_columns(const std::vector<double>& azimuth_deg) {
  std::vector<Column> out;
  for (std::size_t i = 0; i < azimuth_deg.size(); ++i)
    out.push_back({from_mirrored(azimuth_deg[i]), i, i, 0.0});
  std::ranges::stable_sort(out, {}, &Column::azimuth_deg);
  const auto same = [](const Column& a, const Column& b) {
    return b.azimuth_deg - a.azimuth_deg < kSame_deg;
  };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
  return out;
}

/// Those of one side, which stand for both: from 0 to 180.
std::vector<Column> half_circle(std::vector<Column> columns, const BsdfWords& words) {
  // The file may have either side.
  if (columns.back().azimuth_deg > 180.0 + kSame_deg) {
    for (Column& c : columns) c.azimuth_deg = c.azimuth_deg < kSame_deg ? 0.0 : 360.0 - c.azimuth_deg;
    std::ranges::stable_sort(columns, {}, &Column::azimuth_deg);
  }
  if (columns.front().azimuth_deg > kSame_deg || std::abs(columns.back().azimuth_deg - 180.0) > kSame_deg)
    words.fail(
        "found azimuths from {} to {} degrees about the mirrored direction (270), expected half a circle, "
        "0 to 180",
        columns.front().azimuth_deg, columns.back().azimuth_deg);
  columns.front().azimuth_deg = 0.0;
  columns.back().azimuth_deg = 180.0;
  return columns;
}

/// All around, from 0 to 360: both ends lie between the last column and the first, if there is none.
std::vector<Column> full_circle(std::vector<Column> columns, const BsdfWords& words) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double next = i + 1 < columns.size() ? columns[i + 1].azimuth_deg : columns[0].azimuth_deg + 360.0;
    if (next - columns[i].azimuth_deg > 180.0)
      words.fail(
          "found no azimuth for {} degrees after {} (270 is where a mirror sends the light), expected the "
          "whole circle",
          next - columns[i].azimuth_deg, columns[i].azimuth_deg);
  }
  const Column &first = columns.front(), &last = columns.back();
  Column begin = first;
  if (first.azimuth_deg > 0.0) {
    const double gap = first.azimuth_deg + 360.0 - last.azimuth_deg;
    begin = {0.0, last.from, first.from, (360.0 - last.azimuth_deg) / gap};
    columns.insert(columns.begin(), begin);
  }
  begin.azimuth_deg = 360.0;
  columns.push_back(begin);
  return columns;
}

std::vector<Column> columns_of(const Header& header, BsdfWords& words) {
  words.point_at(header.azimuth_line);
  std::vector<Column> columns = sorted_columns(header.azimuth_deg);
  if (columns.size() == 1) return {{0.0, 0, 0, 0.0}, {180.0, 0, 0, 0.0}};  // the same all around
  const double span = header.azimuth_deg.back() - header.azimuth_deg.front();
  return header.is_symmetrical && span < 180.0 + kSame_deg ? half_circle(std::move(columns), words)
                                                           : full_circle(std::move(columns), words);
}

/// The values of one block at the columns of the table.
struct Slice {
  double total = 0.0, plane_deg = 0.0;
  std::vector<double> brdf;
};

Slice slice_of(const Block& block, const std::vector<double>& values, const std::vector<Column>& columns,
               std::size_t radials) {
  Slice out{block.total, block.plane_deg, {}};
  for (const Column& c : columns) {
    for (std::size_t r = 0; r < radials; ++r)
      out.brdf.push_back(std::lerp(values[c.from * radials + r], values[c.to * radials + r], c.share_of_to));
  }
  return out;
}

/// By incidence.
using Slices = std::map<double, Slice>;

void check_block(const Block& block, const Slices& before, const BsdfWords& words) {
  const double at = *block.incidence_deg;
  if (!(at >= 0.0 && at < 90.0)) words.fail("found an incidence of {} degrees, expected 0 to below 90", at);
  if (before.empty()) return;
  const Slice& first = before.begin()->second;
  if (block.plane_deg != first.plane_deg)
    words.refuse("planes of incidence at {} and {} degrees, expected one", first.plane_deg, block.plane_deg);
  if (before.contains(at)) words.fail("found the incidence of {} degrees twice", at);
}

}  // namespace

BsdfTable read_lighttools_bsdf(BsdfWords& words, double wavelength_nm) {
  const Header header = read_header(words);
  const std::vector<Column> columns = columns_of(header, words);
  const std::size_t radials = header.radial_deg.size(), values = header.azimuth_deg.size() * radials;
  if (values > words.count()) words.fail("the file has {} words, expected {} values", words.count(), values);
  std::map<double, Slices> by_wavelength;
  while (auto block = next_block(words)) {
    std::vector<double> brdf;
    if (!block->is_wanted()) {
      for (std::size_t k = 0; k <= values; ++k) static_cast<void>(words.number("a value"));
      continue;
    }
    Slices& slices = by_wavelength[block->wavelength_nm];
    check_block(*block, slices, words);
    block->total = words.total();
    words.values(values, brdf);
    slices.emplace(*block->incidence_deg, slice_of(*block, brdf, columns, radials));
  }
  if (!words.at_end()) words.fail("found words after DataEnd, expected none");
  if (by_wavelength.empty())
    words.refuse("no BRDF of the front{}, expected one", header.is_tristimulus ? " with TrisY" : "");
  const auto& [found_nm, slices] = *std::ranges::min_element(
      by_wavelength, {}, [&](const auto& one) { return std::abs(one.first - wavelength_nm); });
  BsdfTable table;
  table.is_about_normal = true;
  if (by_wavelength.size() > 1) table.wavelength_nm = found_nm;
  table.radial_deg = header.radial_deg;
  for (const Column& c : columns) table.azimuth_deg.push_back(c.azimuth_deg);
  for (const auto& [incidence_deg, slice] : slices) {
    table.incidence_deg.push_back(incidence_deg);
    table.total.push_back(slice.total);
    table.brdf.insert(table.brdf.end(), slice.brdf.begin(), slice.brdf.end());
  }
  return table;
}

}  // namespace lucerna
