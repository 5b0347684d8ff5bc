// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/formats/illuminance_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "lucerna/core/image/png.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/photometry/formats/photometric_text.h"

namespace lucerna {

namespace {

constexpr std::size_t kMaxMapCells = std::size_t{1} << 24;
constexpr std::uint64_t kMaxMapBytes = std::uint64_t{1} << 30;

/// A text of lines, and the errors in them.
struct Text {
  std::string name;
  std::string decoded;

  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    throw InputError(fmt::format("{}: line {}: {}", name, line, what));
  }
  double number(std::string_view word, std::size_t line) const {
    const auto value = number_from(word);
    if (!value) fail(line, fmt::format("found '{}', expected a number", word.substr(0, 40)));
    return *value;
  }
  double illuminance(std::string_view word, std::size_t line) const {
    const double value = number(word, line);
    if (value < 0.0) fail(line, fmt::format("found {}, expected an illuminance of 0 or more", value));
    return value;
  }
};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  const bool separated = line.find_first_of(",;\t") != std::string_view::npos;
  const std::string_view between = separated ? ",;\t" : " ";
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(between), line.size());
    const std::string_view word = trimmed(line.substr(0, end));
    const bool last = end == line.size();
    if (!word.empty() || (separated && !last)) words.push_back(word);
    line = last ? std::string_view() : line.substr(end + 1);
  }
  return words;
}

IlluminanceMap from_rows(const Text& text, const std::vector<std::string_view>& lines) {
  IlluminanceMap map;
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (line.empty() || line.front() == '#') continue;
    std::vector<double> row;
    for (const std::string_view word : words_of(line)) row.push_back(text.illuminance(word, i + 1));
    if (!rows.empty() && row.size() != map.nx) {
      text.fail(i + 1, fmt::format("found {} numbers, expected {} as in the first row", row.size(), map.nx));
    }
    map.nx = row.size();
    if ((rows.size() + 1) * map.nx > kMaxMapCells) text.fail(i + 1, "more than 16 M cells");
    rows.push_back(std::move(row));
  }
  map.ny = rows.size();
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    map.value.insert(map.value.end(), row->begin(), row->end());
  }
  return map;
}

/// Numbers a coordinate's values in ascending order; they must be evenly spaced.
std::map<double, std::size_t> grid_lines(const Text& text, std::vector<double> at, const char* axis) {
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  std::map<double, std::size_t> index;
  const double step = at.size() > 1 ? (at.back() - at.front()) / static_cast<double>(at.size() - 1) : 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double even = at.front() + step * static_cast<double>(i);
    if (std::abs(at[i] - even) > 1e-3 * step) {
      text.fail(1, fmt::format("{} = {} lies on no even grid of {} values; nearest is {}", axis, at[i],
                               at.size(), even));
    }
    index[at[i]] = i;
  }
  return index;
}

IlluminanceMap from_places(const Text& text, const std::vector<std::string_view>& lines, std::size_t header) {
  struct Cell {
    double x, y, value;
    std::size_t line;
  };
  std::vector<Cell> cells;
  std::vector<double> xs, ys;
  for (std::size_t i = header + 1; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (line.empty() || line.front() == '#') continue;
    const auto words = words_of(line);
    if (words.size() < 3) {
      text.fail(i + 1, fmt::format("found {} columns, expected x_mm, y_mm and a value", words.size()));
    }
    if (cells.size() == kMaxMapCells) text.fail(i + 1, "more than 16 M cells");
    cells.push_back({text.number(words[0], i + 1), text.number(words[1], i + 1),
                     text.illuminance(words[2], i + 1), i + 1});
    xs.push_back(cells.back().x);
    ys.push_back(cells.back().y);
  }
  const auto columns = grid_lines(text, std::move(xs), "x_mm"),
             rows = grid_lines(text, std::move(ys), "y_mm");
  IlluminanceMap map{columns.size(), rows.size(), {}};
  if (map.nx * map.ny != cells.size()) {
    text.fail(header + 1,
              fmt::format("{} places do not fill a grid of {} x {}", cells.size(), map.nx, map.ny));
  }
  map.value.assign(cells.size(), -1.0);
  for (const Cell& c : cells) {
    double& value = map.value[rows.at(c.y) * map.nx + columns.at(c.x)];
    if (value >= 0.0) text.fail(c.line, fmt::format("the place ({}, {}) is there twice", c.x, c.y));
    value = c.value;
  }
  return map;
}

IlluminanceMap checked(IlluminanceMap map, const std::string& name) {
  if (map.value.empty()) throw InputError(fmt::format("{}: found no numbers, expected rows of them", name));
  if (*std::max_element(map.value.begin(), map.value.end()) <= 0.0) {
    throw InputError(fmt::format("{}: is dark everywhere, expected some light", name));
  }
  return map;
}

}  // namespace

double IlluminanceMap::at(double u, double v) const {
  if (!(std::abs(u) <= 1.0 && std::abs(v) <= 1.0)) return 0.0;
  const auto place = [](double t, std::size_t n) {
    const double s = 0.5 * (t + 1.0) * static_cast<double>(n) - 0.5;
    return std::clamp(s, 0.0, static_cast<double>(n - 1));
  };
  const double x = place(u, nx), y = place(v, ny);
  const std::size_t i = std::min(static_cast<std::size_t>(x), nx - 1),
                    j = std::min(static_cast<std::size_t>(y), ny - 1);
  const std::size_t i1 = std::min(i + 1, nx - 1), j1 = std::min(j + 1, ny - 1);
  const double fx = x - static_cast<double>(i), fy = y - static_cast<double>(j);
  const double low = (1.0 - fx) * value[j * nx + i] + fx * value[j * nx + i1];
  const double high = (1.0 - fx) * value[j1 * nx + i] + fx * value[j1 * nx + i1];
  return (1.0 - fy) * low + fy * high;
}

IlluminanceMap read_illuminance_csv(const std::filesystem::path& path) {
  const Text text{path.string(), decoded_text(read_file(path, kMaxMapBytes))};
  const std::vector<std::string_view> lines = lines_of(text.decoded);
  std::size_t first = 0;
  while (first < lines.size() && (trimmed(lines[first]).empty() || trimmed(lines[first]).front() == '#')) {
    ++first;
  }
  if (first < lines.size()) {
    const auto words = words_of(trimmed(lines[first]));
    if (words.size() >= 3 && words[0] == "x_mm" && words[1] == "y_mm") {
      return checked(from_places(text, lines, first), text.name);
    }
  }
  return checked(from_rows(text, lines), text.name);
}

IlluminanceMap read_illuminance_png(const std::filesystem::path& path) {
  const GreyImage image = read_png_grey(path);
  IlluminanceMap map{image.width, image.height, {}};
  for (std::size_t y = image.height; y-- > 0;) {
    const auto row = image.value.begin() + static_cast<std::ptrdiff_t>(y * image.width);
    map.value.insert(map.value.end(), row, row + static_cast<std::ptrdiff_t>(image.width));
  }
  return checked(std::move(map), path.string());
}

}  // namespace lucerna
