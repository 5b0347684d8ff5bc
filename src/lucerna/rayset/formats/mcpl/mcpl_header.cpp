// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/mcpl/mcpl_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/formats/common/little_endian.h"

namespace lucerna {

namespace {

using At = McplHeaderBytes;

/// Texts longer than this are passed over.
constexpr std::size_t kMostText = 1 << 16;

std::optional<double> positive_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  if (!whole || !std::isfinite(value) || !(value > 0.0)) return std::nullopt;
  return value;
}

class HeaderReader {
 public:
  HeaderReader(ByteStream& stream, bool salvage) : stream_(stream), salvage_(salvage) {}

  McplHeader read() {
    take(numbers_, "the header");
    check_kind();
    header_.facts.format = "mcpl";
    header_.facts.length_unit = "cm";
    header_.facts.header.flux_unit = FluxUnit::watt;
    read_record();
    read_texts();
    header_.first_byte = stream_.position();
    name_columns();
    count_particles();
    return std::move(header_);
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(std::uint64_t byte, fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(stream_.name(), fmt::format("byte {}", byte), text, std::forward<Args>(args)...);
  }

  void take(std::span<std::byte> out, std::string_view what) {
    const std::uint64_t from = stream_.position();
    const std::size_t got = stream_.read(out);
    if (got == out.size()) return;
    if (!stream_.fault().empty()) fail(from, "{} expected, but {}", what, stream_.fault());
    fail(from, "{} bytes expected for {}, but the file ends after {}", out.size(), what, got);
  }

  std::uint32_t word(std::size_t at) const { return load<std::uint32_t>(numbers_, at); }

  bool flag(std::size_t at, std::string_view what) const {
    if (word(at) > 1) fail(at, "{} {} found, 0 or 1 expected", what, word(at));
    return word(at) == 1;
  }

  void check_kind() const {
    const std::string kind = load_text(numbers_, 0, 8);
    if (!kind.starts_with("MCPL")) fail(0, "'MCPL' expected, other bytes found");
    const std::string version = kind.substr(At::version, 3);
    if (version != "003") {
      fail(At::version, "version '{}' found, 003 expected: mcpltool of version 1.0 or later rewrites it",
           version);
    }
    const std::string endian = kind.substr(At::endian);
    if (endian != "L") {
      fail(At::endian, "order of bytes '{}' found, L (little-endian) expected", endian);
    }
  }

  void read_record() {
    McplRecord& record = header_.record;
    record.user_flags = flag(At::user_flags, "user flags");
    record.polarisation = flag(At::polarisation, "polarisation");
    record.single_precision = flag(At::single_precision, "single precision");
    record.own_weights = !flag(At::universal_weight, "universal weight");
    header_.pdg_code = load<std::int32_t>(numbers_, At::pdg_code);
    record.own_codes = header_.pdg_code == 0;
    if (!record.own_codes && !is_photon(header_.pdg_code)) {
      fail(At::pdg_code, "PDG code {} of all particles found, 22 (photons) expected", header_.pdg_code);
    }
    if (word(At::particle_size) != record.bytes()) {
      fail(At::particle_size, "{} bytes per particle found, {} expected by the options before",
           word(At::particle_size), record.bytes());
    }
    if (record.own_weights) return;
    std::array<std::byte, 8> weight{};
    take(weight, "the weight of all particles");
    header_.weight = load<double>(weight, 0);
    if (!std::isfinite(header_.weight) || header_.weight < 0.0) {
      fail(At::size, "weight {} of all particles found, a number >= 0 expected", header_.weight);
    }
  }

  /// A text after its length; empty if it is too long to be one that matters.
  std::string text(std::string_view what) {
    std::array<std::byte, 4> head{};
    const std::uint64_t from = stream_.position();
    take(head, fmt::format("the length of {}", what));
    std::uint64_t left = load<std::uint32_t>(head, 0);
    if (left > stream_.most_left())
      fail(from, "{} of {} bytes expected, but the file has {} more at most", what, left,
           stream_.most_left());
    const bool kept = left <= kMostText;
    std::vector<std::byte> bytes;
    while (left > 0) {
      bytes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(left, kMostText)));
      take(bytes, what);
      left -= bytes.size();
    }
    return kept ? load_text(bytes, 0, bytes.size()) : std::string();
  }

  void read_texts() {
    RaySetTexts& texts = header_.facts.header.texts;
    const std::string source = text("the source's name");
    if (source != kMcplSource) texts.file_creator = source;
    for (std::uint32_t c = 0; c < word(At::comments); ++c) read_comment(text("a comment"));
    // Keys first, then what they stand for.
    for (std::uint32_t b = 0; b < word(At::blobs); ++b) text("the key of a blob");
    for (std::uint32_t b = 0; b < word(At::blobs); ++b) text("a blob");
  }

  void read_comment(std::string_view comment) {
    if (!comment.starts_with(kMcplCommentPrefix)) return;
    comment.remove_prefix(kMcplCommentPrefix.size());
    const std::size_t blank = std::min(comment.find(' '), comment.size());
    const std::string_view key = comment.substr(0, blank),
                           value = comment.substr(std::min(blank + 1, comment.size()));
    RaySetHeader& header = header_.facts.header;
    if (key == "unit" && value == "lm") header.flux_unit = FluxUnit::lumen;
    if (key == "light_source") header.texts.light_source = value;
    if (key == "flux_w") header.flux_w = positive_number(value);
    if (key == "flux_lm") header.flux_lm = positive_number(value);
  }

  void name_columns() {
    auto& columns = header_.facts.header.columns;
    columns = {{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
    if (header_.record.polarisation) {
      for (const std::string_view label : kMcplPolarisation)
        columns.push_back({ColumnKind::additional, std::string(label)});
    }
    if (header_.record.user_flags) columns.push_back({ColumnKind::additional, std::string(kMcplFlags)});
  }

  void count_particles() {
    const auto announced = load<std::uint64_t>(numbers_, At::particles);
    const std::size_t bytes = header_.record.bytes();
    const std::uint64_t room = stream_.most_left() / bytes;
    RayFileFacts& facts = header_.facts;
    if (stream_.is_packed()) {
      if (announced > room)
        fail(At::particles, "{} particles of {} bytes found, but {} packed bytes hold {} at most", announced,
             bytes, stream_.file().size(), room);
      facts.ray_count = announced;
      return;
    }
    // The count is put in last: 0 before particles is what a program that ended early leaves.
    if (announced == 0 && room > 0) {
      const std::string what =
          fmt::format("0 particles found before {} whole ones: the file was not closed", room);
      if (!salvage_)
        throw_input_error_for("salvage", stream_.name(), fmt::format("byte {}", At::particles),
                              "{}; their number expected", what);
      facts.warnings.push_back(fmt::format("byte {}: {}: they are read", At::particles, what));
      facts.ray_count = room;
      return;
    }
    facts.ray_count = whole_records(stream_.file(), announced, At::particles, header_.first_byte, bytes,
                                    salvage_, facts.warnings);
  }

  ByteStream& stream_;
  bool salvage_;
  std::array<std::byte, At::size> numbers_{};
  McplHeader header_;
};

}  // namespace

McplHeader read_mcpl_header(ByteStream& stream, bool salvage) { return HeaderReader(stream, salvage).read(); }

}  // namespace lucerna
