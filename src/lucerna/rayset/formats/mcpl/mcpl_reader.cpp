// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/rayset/formats/common/little_endian.h"
#include "lucerna/rayset/formats/common/ray_fault.h"
#include "lucerna/rayset/formats/mcpl/mcpl.h"
#include "lucerna/rayset/formats/mcpl/mcpl_direction.h"
#include "lucerna/rayset/formats/mcpl/mcpl_header.h"

namespace lucerna {

namespace {

/// Particles that one thread converts at a time.
constexpr std::size_t kMcplPart = 8192;
/// Whole numbers up to here are exact in a float32 column.
constexpr std::uint32_t kMostExactFlags = 1U << 24;

/// What one part of a block found: its first faulty ray, and the first of each thing that is not kept.
struct PartFindings {
  std::optional<RayFault> fault;
  std::optional<std::size_t> timed, rounded;
};

class McplReader final : public RayReader {
 public:
  McplReader(ByteStream stream, McplHeader header, bool salvage)
      : stream_(std::move(stream)),
        record_(header.record),
        first_byte_(header.first_byte),
        weight_(header.weight),
        pdg_code_(header.pdg_code),
        salvage_(salvage) {
    header_ = std::move(header.facts.header);
    ray_count_ = header.facts.ray_count;
    format_ = std::move(header.facts.format);
    name_ = stream_.name();
    length_unit_ = std::move(header.facts.length_unit);
    warnings_ = std::move(header.facts.warnings);
  }

  std::size_t read(RayBlock& block, std::size_t max_rays) override {
    while (next_ < ray_count_) {
      const std::size_t n = fetch(max_rays);
      if (n == 0) break;
      block.resize(n, header_.columns.size());
      const auto found = parallel_map_blocks<PartFindings>(
          n, kMcplPart, [&](std::size_t first, std::size_t last) { return read_part(block, first, last); });
      note_losses(found);
      const auto bad = std::ranges::find_if(found, [](const auto& f) { return f.fault.has_value(); });
      if (bad != found.end()) leave_out(block, *bad->fault);
      next_ += n;
      if (next_ == ray_count_) check_end();
      if (!block.empty()) return block.size();
    }
    if (ray_count_ == 0) check_end();
    block.resize(0, header_.columns.size());
    return 0;
  }

 private:
  double number(std::size_t ray, std::size_t at) const {
    const std::size_t offset = ray * record_.bytes() + at;
    return record_.single_precision ? static_cast<double>(load<float>(bytes_, offset))
                                    : load<double>(bytes_, offset);
  }

  std::int32_t code(std::size_t ray) const {
    return record_.own_codes ? load<std::int32_t>(bytes_, ray * record_.bytes() + record_.code()) : pdg_code_;
  }

  std::uint64_t byte_of(std::uint64_t ray) const { return first_byte_ + ray * record_.bytes(); }

  /// The next particles into `bytes_`; returns how many are whole.
  std::size_t fetch(std::size_t max_rays) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(max_rays, ray_count_ - next_));
    bytes_.resize(wanted * record_.bytes());
    const std::size_t got = stream_.read(bytes_), whole = got / record_.bytes();
    if (whole == wanted) return wanted;
    const std::string what =
        fmt::format("{} whole particles expected, {} found: {}", ray_count_, next_ + whole,
                    stream_.fault().empty() ? "the unpacked file ends" : stream_.fault());
    if (!salvage_)
      throw_input_error_for("salvage", name_, fmt::format("byte {}", stream_.position()), "{}", what);
    warnings_.push_back(fmt::format("byte {}: {}: the whole ones are read", stream_.position(), what));
    ray_count_ = next_ + whole;
    ended_ = true;
    return whole;
  }

  /// A gzip stream has a checksum at its end.
  void check_end() {
    if (ended_ || !stream_.is_packed()) return;
    ended_ = true;
    std::array<std::byte, 1> more{};
    if (stream_.read(more) == 1) {
      warnings_.push_back(fmt::format("byte {}: bytes after the last particle", stream_.position() - 1));
    } else if (!stream_.fault().empty()) {
      if (!salvage_)
        throw_input_error_for("salvage", name_, fmt::format("byte {}", stream_.position()),
                              "the end of the gzip stream expected, but {}", stream_.fault());
      warnings_.push_back(fmt::format("byte {}: {}", stream_.position(), stream_.fault()));
    }
  }

  void read_ray(RayBlock& block, std::size_t i) const {
    const std::size_t bytes = record_.number_bytes(), place = record_.place(), way = record_.direction();
    const auto coordinate_mm = [&](std::size_t c) {
      return static_cast<float>(number(i, place + c * bytes) * kMcplMmPerCm);
    };
    block.x_mm[i] = coordinate_mm(0), block.y_mm[i] = coordinate_mm(1), block.z_mm[i] = coordinate_mm(2);
    const double energy = number(i, way + 2 * bytes), energy_mev = std::abs(energy);
    const Vec3 k = unpack_direction({number(i, way), number(i, way + bytes), std::signbit(energy)});
    block.kx[i] = static_cast<float>(k.x), block.ky[i] = static_cast<float>(k.y);
    block.kz[i] = static_cast<float>(k.z);
    const double photons = record_.own_weights ? number(i, record_.weight()) : weight_;
    // What is no photon becomes a faulty ray.
    block.weight[i] = is_photon(code(i)) ? static_cast<float>(photons * energy_mev * kMcplJoulePerMeV)
                                         : std::numeric_limits<float>::quiet_NaN();
    block.extra[0][i] = static_cast<float>(kMcplNmMeV / energy_mev);
    for (std::size_t c = 0; record_.polarisation && c < 3; ++c)
      block.extra[1 + c][i] = static_cast<float>(number(i, c * bytes));
  }

  PartFindings read_part(RayBlock& block, std::size_t first, std::size_t last) const {
    PartFindings found;
    for (std::size_t i = first; i < last; ++i) {
      read_ray(block, i);
      if (!found.timed && number(i, record_.time()) != 0.0) found.timed = i;
      if (!record_.user_flags) continue;
      const auto flags = load<std::uint32_t>(bytes_, i * record_.bytes() + record_.flags());
      const auto rounded = static_cast<float>(flags);
      block.extra.back()[i] = rounded;
      if (!found.rounded && flags > kMostExactFlags && static_cast<double>(rounded) != flags)
        found.rounded = i;
    }
    found.fault = check_rays(block, header_.columns, first, last);
    return found;
  }

  /// One warning of each kind for the whole file.
  void note_losses(const std::vector<PartFindings>& found) {
    for (const PartFindings& part : found) {
      if (part.timed && !timed_) {
        timed_ = true;
        warnings_.push_back(fmt::format("ray {}: times are not kept: {} ms is the first", next_ + *part.timed,
                                        number(*part.timed, record_.time())));
      }
      if (part.rounded && !rounded_) {
        rounded_ = true;
        warnings_.push_back(fmt::format(
            "ray {}: user flags above 2^24 are rounded to float32: {} is the first", next_ + *part.rounded,
            load<std::uint32_t>(bytes_, *part.rounded * record_.bytes() + record_.flags())));
      }
    }
  }

  std::string fault_text(const RayFault& fault) const {
    if (is_photon(code(fault.index))) return fault.what;
    return fmt::format("PDG code {} found, 22 (a photon) expected", code(fault.index));
  }

  void leave_out(RayBlock& block, const RayFault& first) {
    const std::uint64_t ray = next_ + first.index;
    if (!salvage_) {
      throw_input_error_for("salvage", name_, fmt::format("ray {} (byte {})", ray, byte_of(ray)), "{}",
                            fault_text(first));
    }
    RayFault example;
    const std::uint64_t more = drop_faulty_rays(block, header_.columns, example);
    if (dropped_ == 0) {
      warnings_.push_back(fmt::format("ray {}: {}; this ray and any other faulty one was left out",
                                      next_ + example.index, fault_text(example)));
    }
    dropped_ += more;
  }

  ByteStream stream_;
  McplRecord record_;
  std::uint64_t first_byte_;
  double weight_;
  std::int32_t pdg_code_;
  bool salvage_, ended_ = false, timed_ = false, rounded_ = false;
  std::uint64_t next_ = 0;
  std::vector<std::byte> bytes_;
};

}  // namespace

bool looks_like_mcpl(const InputFile& file) {
  std::array<std::byte, 4> head{};
  if (file.size() < head.size()) return false;
  if (is_gzip(file)) {
    // A handle of its own: what the caller has stays as it is.
    if (ByteStream(InputFile(file.name())).read(head) < head.size()) return false;
  } else {
    file.read_at(0, head);
  }
  return load_text(head, 0, head.size()) == "MCPL";
}

std::unique_ptr<RayReader> open_mcpl(InputFile file, const ReadOptions& options) {
  ByteStream stream(std::move(file));
  McplHeader header = read_mcpl_header(stream, options.salvage);
  return std::make_unique<McplReader>(std::move(stream), std::move(header), options.salvage);
}

}  // namespace lucerna
