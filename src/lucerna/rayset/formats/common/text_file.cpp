// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/common/text_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// Bytes read at a time, parsed per thread at a time, and looked at beyond a piece while lines are counted.
constexpr std::uint64_t kChunk = 1 << 23, kPiece = 1 << 17, kLookAhead = 256;
constexpr std::size_t kMaxNumbers = 64;

bool is_separator(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }
bool is_comment(char c) { return c == '#' || c == '!'; }

const char* skip_separators(const char* p, const char* end) {
  while (p != end && is_separator(*p)) ++p;
  return p;
}

/// Reads one number; null if there is none. What float32 cannot hold becomes 0 or infinite.
const char* parse(const char* p, const char* end, float& value) {
  if (p != end && *p == '+') ++p;
  auto [rest, error] = std::from_chars(p, end, value);
  if (error == std::errc::result_out_of_range) {
    double wide = 0.0;
    const auto again = std::from_chars(p, end, wide);
    const std::string_view text(p, static_cast<std::size_t>(rest - p));
    const bool tiny = text.find("e-") != text.npos || text.find("E-") != text.npos ||
                      text.starts_with("0.") || text.starts_with("-0.");
    const bool held = again.ec == std::errc() && std::abs(wide) < 1.0;
    value = held ? static_cast<float>(wide) : tiny ? 0.0F : std::numeric_limits<float>::infinity();
  } else if (error != std::errc()) {
    return nullptr;
  }
  return rest == end || is_separator(*rest) || *rest == '\n' ? rest : nullptr;
}

/// Numbers of the line that begins at `p`, into `out` (as many as fit); negative if there is something else.
/// Moves `p` past the line.
int parse_line(const char*& p, const char* end, float* out) {
  int n = 0;
  for (;;) {
    p = skip_separators(p, end);
    if (p == end) return n;
    if (*p == '\n') return ++p, n;
    float value = 0.0F;
    const char* rest = parse(p, end, value);
    if (rest == nullptr) {
      const void* line_end = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
      p = line_end == nullptr ? end : static_cast<const char*>(line_end) + 1;
      return -1;
    }
    if (n < static_cast<int>(kMaxNumbers)) out[n] = value;
    ++n;
    p = rest;
  }
}

/// What one thread made of its piece of text.
struct Piece {
  RayBlock rays;
  std::uint64_t lines = 0, dropped = 0;
  std::optional<RayFault> fault;  // index: line within the piece
};

class PieceParser {
 public:
  PieceParser(const RecordLayout& layout, const std::vector<ColumnSpec>& columns, bool salvage)
      : layout_(layout), columns_(columns), salvage_(salvage) {}

  Piece parse_piece(std::string_view text) const {
    Piece piece;
    const std::size_t max = text.size() / (2 * layout_.floats) + 1;  // a digit and a separator each
    piece.rays.resize(max, layout_.extra.size());
    std::vector<std::uint32_t> line_of;
    line_of.reserve(text.size() / (8 * layout_.floats) + 1);
    const char *p = text.data(), *end = p + text.size();
    float numbers[kMaxNumbers] = {};
    std::size_t n = 0;
    for (; p != end; ++piece.lines) {
      const char* first = skip_separators(p, end);
      if (first != end && is_comment(*first)) {
        const void* line_end = std::memchr(first, '\n', static_cast<std::size_t>(end - first));
        p = line_end == nullptr ? end : static_cast<const char*>(line_end) + 1;
        continue;
      }
      const int found = parse_line(p, end, numbers);
      if (found == 0) continue;
      if (found != static_cast<int>(layout_.floats)) {
        note(piece, piece.lines,
             found < 0 ? fmt::format("{} numbers expected, something else found", layout_.floats)
                       : fmt::format("{} numbers expected, {} found", layout_.floats, found));
        continue;
      }
      put(piece.rays, n++, numbers);
      line_of.push_back(static_cast<std::uint32_t>(piece.lines));
    }
    piece.rays.resize(n);
    check(piece, line_of);
    return piece;
  }

 private:
  static void note(Piece& piece, std::uint64_t line, std::string what) {
    ++piece.dropped;
    if (!piece.fault || line < piece.fault->index) piece.fault = RayFault{line, std::move(what)};
  }

  void put(RayBlock& rays, std::size_t i, const float* numbers) const {
    const auto value = [&](const RecordColumn& c) {
      if (c.at < 0) return static_cast<float>(c.offset);
      if (c.scale == 1.0 && c.offset == 0.0) return numbers[c.at];
      return static_cast<float>(static_cast<double>(numbers[c.at]) * c.scale + c.offset);
    };
    rays.x_mm[i] = value(layout_.main[0]);
    rays.y_mm[i] = value(layout_.main[1]);
    rays.z_mm[i] = value(layout_.main[2]);
    rays.kx[i] = value(layout_.main[3]);
    rays.ky[i] = value(layout_.main[4]);
    rays.kz[i] = value(layout_.main[5]);
    rays.weight[i] = value(layout_.main[6]);
    for (std::size_t c = 0; c < layout_.extra.size(); ++c) rays.extra[c][i] = value(layout_.extra[c]);
  }

  void check(Piece& piece, const std::vector<std::uint32_t>& line_of) const {
    const auto fault = check_rays(piece.rays, columns_, 0, piece.rays.size());
    if (!fault) return;
    note(piece, line_of[fault->index], fault->what);
    if (!salvage_) return;
    RayFault example;
    piece.dropped += drop_faulty_rays(piece.rays, columns_, example) - 1;
  }

  const RecordLayout& layout_;
  const std::vector<ColumnSpec>& columns_;
  bool salvage_;
};

/// Cuts a text into pieces of whole lines.
std::vector<std::string_view> cut(std::string_view text) {
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    const std::size_t line_end = text.size() <= kPiece ? text.npos : text.find('\n', kPiece);
    const std::size_t size = line_end == text.npos ? text.size() : line_end + 1;
    pieces.push_back(text.substr(0, size));
    text.remove_prefix(size);
  }
  return pieces;
}

/// Lines with a ray that begin in [first, last); one begins at `begin` and after each line end.
std::uint64_t count_part(const InputFile& file, std::uint64_t begin, std::uint64_t first, std::uint64_t last,
                         std::uint64_t end) {
  const std::uint64_t from = first == begin ? first : first - 1, to = std::min(end, last + kLookAhead);
  std::string text(to - from, '\0');
  file.read_at(from, std::as_writable_bytes(std::span(text)));
  const char *p = text.data(), *text_end = p + text.size(), *last_start = p + (last - from);
  std::uint64_t count = 0;
  bool at_start = first == begin;
  while (p < text_end) {
    if (!at_start) {
      const void* line_end = std::memchr(p, '\n', static_cast<std::size_t>(text_end - p));
      if (line_end == nullptr) break;
      p = static_cast<const char*>(line_end) + 1;
    }
    at_start = false;
    if (p >= last_start) break;
    const char* q = skip_separators(p, text_end);
    if (q != text_end && *q != '\n' && !is_comment(*q)) ++count;
    if (q != text_end && *q == '\n') p = q;
  }
  return count;
}

}  // namespace

TextReader::TextReader(InputFile file, RayFileFacts facts, TextLayout layout, bool salvage)
    : file_(std::move(file)),
      layout_(std::move(layout)),
      salvage_(salvage),
      next_byte_(layout_.begin),
      next_line_(layout_.first_line) {
  LUCERNA_CHECK(
      layout_.numbers.extra.size() == facts.header.columns.size() && layout_.numbers.floats <= kMaxNumbers,
      "{} columns", layout_.numbers.floats);
  header_ = std::move(facts.header);
  pending_.resize(0, header_.columns.size());
  ray_count_ = facts.ray_count;
  format_ = std::move(facts.format);
  name_ = file_.name();
  length_unit_ = std::move(facts.length_unit);
  warnings_ = std::move(facts.warnings);
}

void TextReader::fill() {
  std::string text(std::min(kChunk, layout_.end - next_byte_), '\0');
  file_.read_at(next_byte_, std::as_writable_bytes(std::span(text)));
  if (next_byte_ + text.size() < layout_.end) {
    const std::size_t line_end = text.rfind('\n');
    if (line_end == text.npos)
      throw_input_error(name_, fmt::format("line {}", next_line_),
                        "a line of numbers expected, {} bytes without an end found", text.size());
    text.resize(line_end + 1);
  }
  const auto pieces = cut(text);
  const PieceParser parser(layout_.numbers, header_.columns, salvage_);
  const auto parsed = parallel_map_blocks<Piece>(
      pieces.size(), 1, [&](std::size_t i, std::size_t) { return parser.parse_piece(pieces[i]); });
  pending_.resize(0, header_.columns.size());
  used_ = 0;
  for (const Piece& piece : parsed) {
    if (piece.fault) {
      const std::uint64_t line = next_line_ + piece.fault->index;
      if (!salvage_) throw_input_error(name_, fmt::format("line {}", line), "{}", piece.fault->what);
      if (dropped_ == 0)
        warnings_.push_back(fmt::format("line {}: {}; this line and any other faulty one was left out", line,
                                        piece.fault->what));
      dropped_ += piece.dropped;
    }
    pending_.append(piece.rays);
    next_line_ += piece.lines;
  }
  next_byte_ += text.size();
}

std::size_t TextReader::read(RayBlock& block, std::size_t max_rays) {
  block.resize(0, header_.columns.size());
  while (used_ == pending_.size() && next_byte_ < layout_.end && delivered_ < ray_count_) fill();
  const auto n = static_cast<std::size_t>(
      std::min<std::uint64_t>({max_rays, pending_.size() - used_, ray_count_ - delivered_}));
  const auto copy = [&](const std::vector<float>& from, std::vector<float>& to) {
    const auto first = from.begin() + static_cast<std::ptrdiff_t>(used_);
    to.assign(first, first + static_cast<std::ptrdiff_t>(n));
  };
  copy(pending_.x_mm, block.x_mm);
  copy(pending_.y_mm, block.y_mm);
  copy(pending_.z_mm, block.z_mm);
  copy(pending_.kx, block.kx);
  copy(pending_.ky, block.ky);
  copy(pending_.kz, block.kz);
  copy(pending_.weight, block.weight);
  for (std::size_t c = 0; c < block.extra.size(); ++c) copy(pending_.extra[c], block.extra[c]);
  used_ += n;
  delivered_ += n;
  return n;
}

std::uint64_t count_lines(const InputFile& file, std::uint64_t begin, std::uint64_t end) {
  if (begin >= end) return 0;
  std::uint64_t sum = 0;
  for (const std::uint64_t part :
       parallel_map_blocks<std::uint64_t>(end - begin, kChunk / 4, [&](std::size_t first, std::size_t last) {
         return count_part(file, begin, begin + first, begin + last, end);
       })) {
    sum += part;
  }
  return sum;
}

std::optional<std::vector<double>> numbers_in(std::string_view line) {
  float numbers[kMaxNumbers] = {};
  const char* p = line.data();
  const int n = parse_line(p, line.data() + line.size(), numbers);
  if (n <= 0 || n > static_cast<int>(kMaxNumbers)) return std::nullopt;
  return std::vector<double>(numbers, numbers + n);
}

bool is_text(const InputFile& file) {
  const std::string head = head_of(file, 4096);
  return !head.empty() && std::ranges::none_of(head, [](char c) {
    return (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7F;
  });
}

std::string head_of(const InputFile& file, std::size_t bytes) {
  std::string head(std::min<std::uint64_t>(bytes, file.size()), '\0');
  file.read_at(0, std::as_writable_bytes(std::span(head)));
  return head;
}

std::vector<std::string_view> lines_in(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t size = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, size);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(size + 1, text.size()));
  }
  return lines;
}

TextRayWriter::TextRayWriter(const std::filesystem::path& path, RecordLayout numbers)
    : file_(path), numbers_(std::move(numbers)) {}

void TextRayWriter::write_rays(const RayBlock& block) {
  LUCERNA_CHECK(block.extra.size() == numbers_.extra.size(), "{} extra columns", block.extra.size());
  // The arrays in the order of the line.
  std::vector<std::pair<const float*, double>> order(numbers_.floats, {nullptr, 1.0});
  const std::array<const std::vector<float>*, 7> main{&block.x_mm, &block.y_mm, &block.z_mm,  &block.kx,
                                                      &block.ky,   &block.kz,   &block.weight};
  for (std::size_t c = 0; c < 7; ++c) {
    if (numbers_.main[c].at >= 0)
      order[static_cast<std::size_t>(numbers_.main[c].at)] = {main[c]->data(), numbers_.main[c].scale};
  }
  for (std::size_t c = 0; c < numbers_.extra.size(); ++c) {
    if (numbers_.extra[c].at >= 0)
      order[static_cast<std::size_t>(numbers_.extra[c].at)] = {block.extra[c].data(),
                                                               numbers_.extra[c].scale};
  }
  constexpr std::size_t kWidth = 20, kPart = 4096;
  for (std::size_t done = 0; done < block.size(); done += kStreamBlock) {
    const std::size_t n = std::min(kStreamBlock, block.size() - done);
    for (const std::string& part :
         parallel_map_blocks<std::string>(n, kPart, [&](std::size_t first, std::size_t last) {
           std::string text((last - first) * kWidth * order.size(), '\0');
           char *p = text.data(), *end = p + text.size();
           for (std::size_t i = done + first; i < done + last; ++i) {
             for (const auto& [array, scale] : order) {
               const float value =
                   scale == 1.0 ? array[i] : static_cast<float>(static_cast<double>(array[i]) / scale);
               p = std::to_chars(p, end, value).ptr;
               *p++ = ' ';
             }
             p[-1] = '\n';
           }
           text.resize(static_cast<std::size_t>(p - text.data()));
           return text;
         })) {
      file_.write(part);
    }
  }
  count_ += block.size();
}

}  // namespace lucerna
