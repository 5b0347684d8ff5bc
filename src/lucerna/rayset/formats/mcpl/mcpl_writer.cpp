// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/rayset/data/ray_wavelengths.h"
#include "lucerna/rayset/formats/common/little_endian.h"
#include "lucerna/rayset/formats/common/record_file.h"
#include "lucerna/rayset/formats/mcpl/mcpl.h"
#include "lucerna/rayset/formats/mcpl/mcpl_direction.h"
#include "lucerna/rayset/formats/mcpl/mcpl_layout.h"

namespace lucerna {

namespace {

constexpr std::size_t kWrittenPart = 8192;

std::optional<std::size_t> additional_column(const RaySetHeader& header, std::string_view label) {
  const auto found =
      std::ranges::find(header.columns, ColumnSpec{ColumnKind::additional, std::string(label)});
  if (found == header.columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header.columns.begin());
}

class McplWriter final : public RayWriter {
 public:
  McplWriter(const std::filesystem::path& path, const RaySetHeader& header)
      : wavelengths_(header, header.flux_unit, kGreen_nm),
        file_(path),
        flags_(additional_column(header, kMcplFlags)) {
    if (std::string warning = wavelengths_warning(wavelengths_); !warning.empty())
      warnings_.push_back(std::move(warning));
    for (std::size_t c = 0; c < 3; ++c) polarisation_[c] = additional_column(header, kMcplPolarisation[c]);
    record_.user_flags = flags_.has_value();
    record_.polarisation = std::ranges::all_of(polarisation_, [](const auto& c) { return c.has_value(); });
    name_losses(header);
    write_header(header);
  }

  void write(const RayBlock& block) override {
    for (std::size_t done = 0; done < block.size(); done += kStreamBlock) {
      const std::size_t n = std::min(kStreamBlock, block.size() - done);
      bytes_.resize(n * record_.bytes());
      const auto odd =
          parallel_map_blocks<std::uint64_t>(n, kWrittenPart, [&](std::size_t first, std::size_t last) {
            std::uint64_t odd_flags = 0;
            for (std::size_t i = first; i < last; ++i) odd_flags += write_ray(block, done + i, i) ? 0 : 1;
            return odd_flags;
          });
      for (const std::uint64_t o : odd) odd_flags_ += o;
      file_.write(bytes_);
      count_ += n;
    }
  }

  void finish() override {
    std::array<std::byte, 8> count{};
    store(count, 0, count_);
    file_.patch(McplHeaderBytes::particles, count);
    if (odd_flags_ > 0) {
      warnings_.push_back(fmt::format(
          "{} user flags are no whole numbers from 0 to 4294967295: the nearest are written", odd_flags_));
    }
    file_.commit();
  }

 private:
  void name_losses(const RaySetHeader& header) {
    RaySetHeader rest = header;
    rest.texts.file_creator.clear();
    std::erase_if(rest.columns, [&](const ColumnSpec& column) {
      if (column.kind != ColumnKind::additional) return false;
      return column.label == kMcplFlags ||
             (record_.polarisation &&
              std::ranges::find(kMcplPolarisation, column.label) != kMcplPolarisation.end());
    });
    for (std::string& lost : losses(rest, "mcpl",
                                    {.wavelengths = true,
                                    .one_wavelength = true,
                                    .table = true,
                                    .source_name = true,
                                    .texts = false}))
      warnings_.push_back(std::move(lost));
    if (header.flux_unit == FluxUnit::lumen)
      warnings_.push_back(
          "mcpl weights are meant as photons; those of the rays' lumens as watts are written");
  }

  static std::vector<std::string> comments_of(const RaySetHeader& header) {
    std::vector<std::string> comments{
        fmt::format("{}unit {}", kMcplCommentPrefix, header.flux_unit == FluxUnit::lumen ? "lm" : "W")};
    if (header.flux_w) comments.push_back(fmt::format("{}flux_w {}", kMcplCommentPrefix, *header.flux_w));
    if (header.flux_lm) comments.push_back(fmt::format("{}flux_lm {}", kMcplCommentPrefix, *header.flux_lm));
    if (!header.texts.light_source.empty())
      comments.push_back(fmt::format("{}light_source {}", kMcplCommentPrefix, header.texts.light_source));
    return comments;
  }

  void write_header(const RaySetHeader& header) {
    using At = McplHeaderBytes;
    const std::vector<std::string> comments = comments_of(header);
    std::vector<std::byte> head(At::size);
    std::memcpy(head.data(), "MCPL003L", 8);
    store(head, At::comments, static_cast<std::uint32_t>(comments.size()));
    store(head, At::user_flags, std::uint32_t{record_.user_flags});
    store(head, At::polarisation, std::uint32_t{record_.polarisation});
    store(head, At::pdg_code, std::int32_t{22});
    store(head, At::particle_size, static_cast<std::uint32_t>(record_.bytes()));
    file_.write(head);
    write_text(header.texts.file_creator.empty() ? kMcplSource : header.texts.file_creator);
    for (const std::string& comment : comments) write_text(comment);
  }

  void write_text(std::string_view text) {
    std::array<std::byte, 4> length{};
    store(length, 0, static_cast<std::uint32_t>(text.size()));
    file_.write(length);
    file_.write(text);
  }

  /// Ray `i` of `block` as particle `at` of `bytes_`; false if its user flags are no such number.
  bool write_ray(const RayBlock& block, std::size_t i, std::size_t at) {
    const std::span<std::byte> out = std::span(bytes_).subspan(at * record_.bytes(), record_.bytes());
    const auto put = [&](std::size_t place, std::size_t c, double value) {
      store(out, place + 8 * c, value);
    };
    for (std::size_t c = 0; record_.polarisation && c < 3; ++c)
      put(0, c, static_cast<double>(block.extra[*polarisation_[c]][i]));
    const Vec3 start = block.origin_mm(i);
    put(record_.place(), 0, start.x / kMcplMmPerCm);
    put(record_.place(), 1, start.y / kMcplMmPerCm);
    put(record_.place(), 2, start.z / kMcplMmPerCm);
    const double energy_mev = kMcplNmMeV / static_cast<double>(wavelengths_.of(block, i, count_ + at));
    const McplDirection k = pack_direction({block.kx[i], block.ky[i], block.kz[i]});
    put(record_.direction(), 0, k.first);
    put(record_.direction(), 1, k.second);
    put(record_.direction(), 2, k.negative ? -energy_mev : energy_mev);
    put(record_.time(), 0, 0.0);
    put(record_.weight(), 0, static_cast<double>(block.weight[i]) / (energy_mev * kMcplJoulePerMeV));
    if (!flags_) return true;
    const auto flags = static_cast<double>(block.extra[*flags_][i]);
    constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
    const double nearest = flags >= 0.0 ? std::min(std::round(flags), kMost) : 0.0;
    store(out, record_.flags(), static_cast<std::uint32_t>(nearest));
    return nearest == flags;
  }

  RayWavelengths wavelengths_;
  OutputFile file_;
  std::optional<std::size_t> flags_;
  std::array<std::optional<std::size_t>, 3> polarisation_;
  McplRecord record_;
  std::vector<std::byte> bytes_;
  std::uint64_t count_ = 0, odd_flags_ = 0;
};

}  // namespace

std::unique_ptr<RayWriter> create_mcpl(const std::filesystem::path& path, const RaySetHeader& header,
                                       const WriteOptions& options) {
  if (options.length_unit != "mm" && options.length_unit != "cm")
    throw UsageError(fmt::format("mcpl: lengths are cm, not {}", options.length_unit));
  return std::make_unique<McplWriter>(path, header);
}

}  // namespace lucerna
