// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/common/record_file.h"

#include <algorithm>
#include <bit>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

static_assert(std::endian::native == std::endian::little,
              "ray files are little-endian; so must the machine be");

namespace {

/// Rays that one thread converts at a time: records and arrays together stay in the second-level cache.
constexpr std::size_t kRecordPart = 8192;

std::array<std::vector<float>*, 7> arrays_of(RayBlock& b) {
  return {&b.x_mm, &b.y_mm, &b.z_mm, &b.kx, &b.ky, &b.kz, &b.weight};
}
std::array<const std::vector<float>*, 7> arrays_of(const RayBlock& b) {
  return {&b.x_mm, &b.y_mm, &b.z_mm, &b.kx, &b.ky, &b.kz, &b.weight};
}

bool is_verbatim(const RecordColumn& column) { return column.scale == 1.0 && column.offset == 0.0; }

float decoded(float value, const RecordColumn& column) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits >= 1 && bits <= column.integers_up_to ? static_cast<float>(bits) : value;
}

void gather(const float* records, std::size_t stride, std::size_t n, const RecordColumn& column, float* out) {
  if (column.at < 0) {
    std::fill_n(out, n, 0.0F);
    return;
  }
  const float* in = records + column.at;
  if (column.integers_up_to > 0) {
    for (std::size_t i = 0; i < n; ++i) out[i] = decoded(in[i * stride], column);
  } else if (is_verbatim(column)) {
    for (std::size_t i = 0; i < n; ++i) out[i] = in[i * stride];
  } else {
    for (std::size_t i = 0; i < n; ++i)
      out[i] = static_cast<float>(static_cast<double>(in[i * stride]) * column.scale + column.offset);
  }
}

void scatter(const float* in, std::size_t n, const RecordColumn& column, std::size_t stride, float* records) {
  if (column.at < 0) return;
  float* out = records + column.at;
  if (is_verbatim(column)) {
    for (std::size_t i = 0; i < n; ++i) out[i * stride] = in[i];
  } else {
    for (std::size_t i = 0; i < n; ++i)
      out[i * stride] = static_cast<float>(static_cast<double>(in[i]) / column.scale);
  }
}

/// The usual record, x y z kx ky kz flux first and in mm: all seven in one sweep over the records.
bool is_plain(const RecordLayout& layout) {
  for (std::size_t c = 0; c < 7; ++c) {
    const RecordColumn& column = layout.main[c];
    if (column.at != static_cast<int>(c) || !is_verbatim(column) || column.integers_up_to != 0) return false;
  }
  return true;
}

}  // namespace

RecordReader::RecordReader(InputFile file, RayFileFacts facts, RecordLayout layout, bool salvage)
    : file_(std::move(file)), layout_(std::move(layout)), salvage_(salvage) {
  LUCERNA_CHECK(layout_.extra.size() == facts.header.columns.size(), "{} columns", layout_.extra.size());
  header_ = std::move(facts.header);
  ray_count_ = facts.ray_count;
  format_ = std::move(facts.format);
  name_ = file_.name();
  length_unit_ = std::move(facts.length_unit);
  warnings_ = std::move(facts.warnings);
}

std::optional<RayFault> RecordReader::read_part(RayBlock& block, std::size_t first, std::size_t last) const {
  thread_local std::vector<float> records;
  const std::size_t n = last - first, stride = layout_.floats;
  records.resize(n * stride);
  file_.read_at(layout_.first_byte + (next_ + first) * layout_.record_bytes(),
                std::as_writable_bytes(std::span(records)));
  const auto main = arrays_of(block);
  if (is_plain(layout_)) {
    float *x = main[0]->data() + first, *y = main[1]->data() + first, *z = main[2]->data() + first;
    float *kx = main[3]->data() + first, *ky = main[4]->data() + first, *kz = main[5]->data() + first;
    float* w = main[6]->data() + first;
    const float* r = records.data();
    for (std::size_t i = 0; i < n; ++i, r += stride) {
      x[i] = r[0], y[i] = r[1], z[i] = r[2];
      kx[i] = r[3], ky[i] = r[4], kz[i] = r[5];
      w[i] = r[6];
    }
  } else {
    for (std::size_t c = 0; c < 7; ++c)
      gather(records.data(), stride, n, layout_.main[c], main[c]->data() + first);
  }
  for (std::size_t c = 0; c < layout_.extra.size(); ++c) {
    gather(records.data(), stride, n, layout_.extra[c], block.extra[c].data() + first);
  }
  return check_rays(block, header_.columns, first, last);
}

void RecordReader::fail(const RayFault& fault) const {
  const std::uint64_t ray = next_ + fault.index;
  throw_input_error(name_,
                    fmt::format("ray {} (byte {})", ray, layout_.first_byte + ray * layout_.record_bytes()),
                    "{}", fault.what);
}

std::size_t RecordReader::read(RayBlock& block, std::size_t max_rays) {
  while (next_ < ray_count_) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(max_rays, ray_count_ - next_));
    block.resize(n, layout_.extra.size());
    const auto faults = parallel_map_blocks<std::optional<RayFault>>(
        n, kRecordPart, [&](std::size_t first, std::size_t last) { return read_part(block, first, last); });
    const auto bad = std::find_if(faults.begin(), faults.end(), [](const auto& f) { return f.has_value(); });
    if (bad != faults.end()) {
      if (!salvage_) fail(**bad);
      RayFault example;
      const std::uint64_t more = drop_faulty_rays(block, header_.columns, example);
      if (dropped_ == 0) {
        warnings_.push_back(fmt::format("ray {}: {}; this ray and any other faulty one was left out",
                                        next_ + example.index, example.what));
      }
      dropped_ += more;
    }
    next_ += n;
    if (!block.empty()) return block.size();
  }
  block.resize(0, layout_.extra.size());
  return 0;
}

RecordWriter::RecordWriter(const std::filesystem::path& path, RecordLayout layout)
    : file_(path), layout_(std::move(layout)) {}

void RecordWriter::write_rays(const RayBlock& block) {
  LUCERNA_CHECK(block.extra.size() == layout_.extra.size(), "{} extra columns, {} expected",
                block.extra.size(), layout_.extra.size());
  const auto main = arrays_of(block);
  const std::size_t stride = layout_.floats;
  for (std::size_t done = 0; done < block.size(); done += kStreamBlock) {
    const std::size_t n = std::min(kStreamBlock, block.size() - done);
    records_.resize(n * stride);
    parallel_blocks(n, kRecordPart, [&](std::size_t first, std::size_t last) {
      float* out = records_.data() + first * stride;
      for (std::size_t c = 0; c < 7; ++c) {
        scatter(main[c]->data() + done + first, last - first, layout_.main[c], stride, out);
      }
      for (std::size_t c = 0; c < layout_.extra.size(); ++c) {
        scatter(block.extra[c].data() + done + first, last - first, layout_.extra[c], stride, out);
      }
    });
    file_.write(std::as_bytes(std::span(records_)));
  }
  count_ += block.size();
}

std::optional<double> mm_per(std::string_view unit) {
  static constexpr std::array<std::pair<std::string_view, double>, 7> kUnits{{{"mm", 1.0},
                                                                              {"cm", 10.0},
                                                                              {"m", 1000.0},
                                                                              {"inch", 25.4},
                                                                              {"feet", 304.8},
                                                                              {"um", 1e-3},
                                                                              {"nm", 1e-6}}};
  const auto found = std::ranges::find(kUnits, unit, &std::pair<std::string_view, double>::first);
  if (found == kUnits.end()) return std::nullopt;
  return found->second;
}

RecordLayout written_layout(const RaySetHeader& header, std::string_view length_unit,
                            double wavelength_scale) {
  RecordLayout layout;
  layout.scale_lengths(*mm_per(length_unit));
  layout.extra.assign(header.columns.size(), RecordColumn{});
  const auto wavelength = find_column(header.columns, ColumnKind::wavelength_nm);
  if (wavelength && wavelength_scale > 0.0) {
    layout.floats = 8;
    layout.extra[*wavelength] = {.at = 7, .scale = wavelength_scale};
  }
  return layout;
}

std::vector<float> peek_records(const InputFile& file, std::uint64_t first_byte, std::size_t floats,
                                std::uint64_t count) {
  const std::uint64_t room = file.size() > first_byte ? (file.size() - first_byte) / (4 * floats) : 0;
  std::vector<float> records(std::min(count, room) * floats);
  if (!records.empty()) file.read_at(first_byte, std::as_writable_bytes(std::span(records)));
  return records;
}

std::vector<std::string> losses(const RaySetHeader& header, std::string_view format,
                                const FormatHolds& holds) {
  std::vector<std::string> lost;
  const auto lose = [&](std::string_view what) {
    lost.push_back(fmt::format("{} has no place for {}", format, what));
  };
  for (const ColumnSpec& column : header.columns) {
    if (column.kind == ColumnKind::wavelength_nm && holds.wavelengths) continue;
    lose(fmt::format("the column '{}'", column.label));
  }
  if (!header.spectra.empty() && !holds.table) lose("the spectral table");
  if (header.wavelength_nm && !holds.one_wavelength) lose("the wavelength of all rays");
  RaySetTexts rest = header.texts;
  if (holds.source_name) rest.light_source.clear();
  if (!holds.texts && rest != RaySetTexts{})
    lose(holds.source_name ? "the texts but for the light source's name" : "the texts");
  return lost;
}

std::uint64_t whole_records(const InputFile& file, std::uint64_t announced, std::uint64_t count_byte,
                            std::uint64_t first_byte, std::uint64_t record_bytes, bool salvage,
                            std::vector<std::string>& warnings) {
  if (!salvage) require_records(file, announced, count_byte, first_byte, record_bytes);
  const std::uint64_t room = file.size() > first_byte ? (file.size() - first_byte) / record_bytes : 0;
  if (announced > room) {
    warnings.push_back(fmt::format("byte {}: {} rays announced, {} are whole: the others are left out",
                                   count_byte, announced, room));
    return room;
  }
  const std::uint64_t end = first_byte + announced * record_bytes;
  if (end < file.size())
    warnings.push_back(fmt::format("byte {}: {} bytes after the last ray", end, file.size() - end));
  return announced;
}

void require_records(const InputFile& file, std::uint64_t count, std::uint64_t count_byte,
                     std::uint64_t first_byte, std::uint64_t record_bytes) {
  const std::uint64_t room = file.size() > first_byte ? (file.size() - first_byte) / record_bytes : 0;
  if (count <= room) return;
  throw_input_error_for(
      "salvage", file.name(), fmt::format("byte {}", count_byte),
      "{} rays of {} bytes expected from byte {}, but the file ends at byte {}: {} whole rays", count,
      record_bytes, first_byte, file.size(), room);
}

}  // namespace lucerna
