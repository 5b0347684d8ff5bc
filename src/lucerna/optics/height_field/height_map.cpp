// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/height_field/height_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

#include "lucerna/core/image/pgm.h"
#include "lucerna/core/image/png.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/io/number_table.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxMapBytes = std::uint64_t{2} << 30;
constexpr std::size_t kMaxHeights = std::size_t{1} << 24;

/// What a NumPy header says: {'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }.
struct NpyHeader {
  std::size_t data_at = 0;
  bool big_endian = false, columns_first = false;
  char kind = 'f';
  std::size_t bytes = 8, rows = 0, columns = 0;
};

class NpyReader {
 public:
  explicit NpyReader(const std::filesystem::path& path)
      : file_(path.string()), bytes_(read_file(path, kMaxMapBytes)) {}

  HeightMap read() const {
    const NpyHeader h = header();
    if (h.rows == 0 || h.columns == 0 || h.rows > kMaxHeights / h.columns)
      fail(10, "an array of {} x {}, expected 4 x 4 to {} numbers", h.rows, h.columns, kMaxHeights);
    const std::size_t need = h.rows * h.columns * h.bytes;
    if (bytes_.size() - h.data_at != need) {
      fail(h.data_at, "{} bytes of data, expected {} for {} x {}", bytes_.size() - h.data_at, need, h.rows,
           h.columns);
    }
    HeightMap map{h.columns, h.rows, std::vector<double>(h.rows * h.columns), std::nullopt};
    for (std::size_t row = 0; row < h.rows; ++row) {
      for (std::size_t column = 0; column < h.columns; ++column) {
        const std::size_t i = h.columns_first ? column * h.rows + row : row * h.columns + column;
        const double z = value(h, h.data_at + i * h.bytes);
        if (!std::isfinite(z)) {
          throw_input_error(file_, fmt::format("row {}, column {}", row + 1, column + 1),
                            "found {}, expected a finite number", z);
        }
        map.z[row * h.columns + column] = z;
      }
    }
    return map;
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(std::size_t at, fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, fmt::format("byte {}", at), text, std::forward<Args>(args)...);
  }

  /// The text after 'key': in the header.
  std::string_view entry(std::string_view header, std::string_view key) const {
    const std::size_t at = header.find(fmt::format("'{}':", key));
    if (at == std::string_view::npos) fail(10, "the header has no {}", key);
    std::string_view rest = header.substr(at + key.size() + 3);
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    return rest;
  }

  NpyHeader header() const {
    const std::string_view all = bytes_;
    if (all.size() < 12 || !all.starts_with("\x93NUMPY")) fail(0, "this is no NumPy file");
    const bool old = all[6] == 1;
    std::size_t size = 0;
    for (std::size_t k = old ? 2 : 4; k-- > 0;) size = size << 8 | static_cast<unsigned char>(all[8 + k]);
    NpyHeader h;
    h.data_at = (old ? 10 : 12) + size;
    if (h.data_at > all.size()) fail(8, "a header of {} bytes, the file has {}", size, all.size());
    const std::string_view text = all.substr(old ? 10 : 12, size);
    const std::string_view type = entry(text, "descr");
    h.big_endian = type.size() > 1 && type[1] == '>';
    h.kind = type.size() > 2 ? type[2] : ' ';
    h.bytes = type.size() > 3 ? static_cast<std::size_t>(type[3] - '0') : 0;
    const bool number = (h.kind == 'f' && (h.bytes == 4 || h.bytes == 8)) ||
                        ((h.kind == 'i' || h.kind == 'u') && (h.bytes == 1 || h.bytes == 2 || h.bytes == 4));
    if (!number || type.size() < 5 || type[4] != '\'') {
      fail(10, "numbers of type {}, expected f4, f8, or i and u of 1, 2 or 4 bytes",
           type.substr(0, std::min<std::size_t>(type.find(','), 12)));
    }
    h.columns_first = entry(text, "fortran_order").starts_with("True");
    std::string_view shape = entry(text, "shape");
    shape = shape.substr(0, shape.find(')'));
    std::vector<std::size_t> sizes;
    while (true) {
      shape.remove_prefix(std::min(shape.find_first_of("0123456789"), shape.size()));
      if (shape.empty()) break;
      std::size_t n = 0;
      const auto [end, error] = std::from_chars(shape.data(), shape.data() + shape.size(), n);
      if (error != std::errc()) fail(10, "a size in the shape is too large");
      shape.remove_prefix(static_cast<std::size_t>(end - shape.data()));
      sizes.push_back(n);
    }
    if (sizes.size() != 2) fail(10, "an array of {} dimensions, expected 2 (rows, columns)", sizes.size());
    h.rows = sizes[0];
    h.columns = sizes[1];
    return h;
  }

  double value(const NpyHeader& h, std::size_t at) const {
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < h.bytes; ++k) {
      const std::size_t place = h.big_endian ? at + k : at + h.bytes - 1 - k;
      bits = bits << 8 | static_cast<unsigned char>(bytes_[place]);
    }
    if (h.kind == 'f')
      return h.bytes == 8 ? std::bit_cast<double>(bits)
                          : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    const std::uint64_t sign = std::uint64_t{1} << (8 * h.bytes - 1);
    if (h.kind == 'i' && (bits & sign) != 0)
      return static_cast<double>(bits) - 2.0 * static_cast<double>(sign);
    return static_cast<double>(bits);
  }

  std::string file_, bytes_;
};

HeightMap from_picture(const GreyImage& image, const std::string& file) {
  if (image.colour) throw_input_error(file, "", "has colours, expected a grey picture of heights");
  HeightMap map{image.width, image.height, image.value, image.white};
  for (double& z : map.z) z = std::round(z * image.white);
  return map;
}

}  // namespace

HeightMap read_height_map(const std::filesystem::path& path, FirstRow first_row) {
  const std::string ending = lower_ending(path);
  HeightMap map;
  if (ending == ".csv" || ending == ".txt") {
    NumberTable table = read_number_table(path);
    map = {table.columns, table.rows, std::move(table.numbers), std::nullopt};
  } else if (ending == ".npy") {
    map = NpyReader(path).read();
  } else if (ending == ".pgm") {
    map = from_picture(read_pgm(path), path.string());
  } else if (ending == ".png") {
    map = from_picture(read_png_grey(path), path.string());
  } else {
    throw_input_error(path.string(), "", "ends in '{}', expected .csv, .txt, .npy, .pgm or .png", ending);
  }
  if (map.nx < 4 || map.ny < 4) {
    throw_input_error(path.string(), "", "holds {} x {} heights, expected at least 4 x 4", map.nx, map.ny);
  }
  if (first_row == FirstRow::top) {
    for (std::size_t row = 0; 2 * row + 1 < map.ny; ++row) {
      std::swap_ranges(map.z.begin() + static_cast<std::ptrdiff_t>(row * map.nx),
                       map.z.begin() + static_cast<std::ptrdiff_t>((row + 1) * map.nx),
                       map.z.begin() + static_cast<std::ptrdiff_t>((map.ny - 1 - row) * map.nx));
    }
  }
  return map;
}

}  // namespace lucerna
