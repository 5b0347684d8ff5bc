// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/formats/ies_body.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

struct Token {
  std::string_view text;
  std::size_t line = 0;
};

std::vector<Token> tokens_of(const std::vector<std::string_view>& lines, std::size_t from, bool comma_parts) {
  std::vector<Token> tokens;
  for (std::size_t i = from; i < lines.size(); ++i) {
    const std::string_view line = lines[i];
    const auto parts = [&](char c) {
      return static_cast<unsigned char>(c) <= 32 || (comma_parts && c == ',');
    };
    for (std::size_t at = 0; at < line.size();) {
      if (parts(line[at])) {
        ++at;
        continue;
      }
      std::size_t end = at + 1;
      while (end < line.size() && !parts(line[end])) ++end;
      tokens.push_back({line.substr(at, end - at), i + 1});
      at = end;
    }
  }
  return tokens;
}

/// Reads tokens in order. With `comma_decimals` a comma within a token is its decimal point.
class Cursor {
 public:
  Cursor(const std::vector<Token>& tokens, bool comma_decimals, const RepairLog& log)
      : tokens_(tokens), comma_decimals_(comma_decimals), log_(log) {}

  std::size_t position() const { return at_; }
  void seek(std::size_t at) { at_ = at; }
  std::size_t left() const { return tokens_.size() - at_; }
  std::size_t line() const {
    return at_ < tokens_.size() ? tokens_[at_].line : tokens_.empty() ? 0 : tokens_.back().line;
  }
  std::string_view text() const { return at_ < tokens_.size() ? tokens_[at_].text : std::string_view(); }

  double number(const char* what) {
    if (at_ >= tokens_.size()) log_.fail(line(), "the file ends where {} is expected", what);
    const std::optional<double> value = parse(tokens_[at_].text);
    if (!value) log_.fail(line(), "'{}' found where {} is expected", tokens_[at_].text.substr(0, 40), what);
    ++at_;
    return *value;
  }

  std::size_t count(const char* what, std::size_t lowest) {
    const std::size_t at_line = line();
    const double value = number(what);
    if (value != std::floor(value) || value < static_cast<double>(lowest) || value > 1e9) {
      log_.fail(at_line, "{} is {}, a whole number of at least {} expected", what, value, lowest);
    }
    return static_cast<std::size_t>(value);
  }

  std::vector<double> numbers(std::size_t n, const char* what) {
    std::vector<double> values;
    values.reserve(std::min(n, left()));
    for (std::size_t i = 0; i < n; ++i) values.push_back(number(what));
    return values;
  }

 private:
  std::optional<double> parse(std::string_view text) const {
    if (!comma_decimals_ || text.find(',') == std::string_view::npos) return number_from(text);
    std::string with_point(text);
    std::replace(with_point.begin(), with_point.end(), ',', '.');
    return number_from(with_point);
  }

  const std::vector<Token>& tokens_;
  bool comma_decimals_;
  const RepairLog& log_;
  std::size_t at_ = 0;
};

/// Fields before the angles, and the counts.
struct Head {
  IesBody body;
  std::size_t nv = 0, nh = 0;
  std::size_t need = 0;  ///< tokens that the whole takes, with record 2
};

/// Everything up to record 1.
Head read_head(Cursor& cursor, bool tilt_included, const RepairLog& log) {
  Head head;
  IesBody& body = head.body;
  if (tilt_included) {
    body.tilt_geometry =
        static_cast<int>(std::min<std::size_t>(cursor.count("the lamp-to-luminaire geometry", 0), 100));
    const std::size_t n = cursor.count("the number of tilt angles", 0);
    if (n > cursor.left() / 2)
      log.fail(cursor.line(), "{} tilt angles do not fit into {} values", n, cursor.left());
    const std::vector<double> angles = cursor.numbers(n, "a tilt angle");
    const std::vector<double> factors = cursor.numbers(n, "a tilt factor");
    for (std::size_t i = 0; i < n; ++i) body.tilt_factors.emplace_back(angles[i], factors[i]);
  }
  body.first_line = cursor.line();
  body.lamps = cursor.number("the number of lamps");
  body.lumens_per_lamp = cursor.number("the lumens per lamp");
  body.multiplier = cursor.number("the candela multiplier");
  const std::size_t count_line = cursor.line();
  head.nv = cursor.count("the number of vertical angles", 2);
  head.nh = cursor.count("the number of horizontal angles", 1);
  body.type = static_cast<int>(std::min<std::size_t>(cursor.count("the photometric type", 0), 100));
  body.units = static_cast<int>(std::min<std::size_t>(cursor.count("the unit of length", 0), 100));
  body.width = cursor.number("the width");
  body.length = cursor.number("the length");
  body.height = cursor.number("the height");
  if (head.nv > cursor.left() || head.nh > cursor.left() || head.nv > cursor.left() / head.nh) {
    log.fail(count_line, "{} x {} intensities promised, {} values left in the file", head.nv, head.nh,
             cursor.left());
  }
  head.need = cursor.position() + 3 + head.nv + head.nh + head.nv * head.nh;
  return head;
}

bool fits(std::size_t found, std::size_t need) { return found == need || found + 3 == need; }

/// How commas are meant: true = as decimal points. By the count of values, parting commas first.
bool commas_are_decimals(const std::vector<Token>& parted, const std::vector<Token>& whole,
                         bool tilt_included) {
  const RepairLog quiet("", false);
  const auto count_fits = [&](const std::vector<Token>& tokens, bool decimals, bool exactly) {
    try {
      Cursor cursor(tokens, decimals, quiet);
      const Head head = read_head(cursor, tilt_included, quiet);
      return exactly ? fits(tokens.size(), head.need) : tokens.size() + 3 >= head.need;
    } catch (const InputError&) {
      return false;
    }
  };
  if (count_fits(parted, false, true)) return false;
  if (count_fits(whole, true, true)) return true;
  return !count_fits(parted, false, false) && count_fits(whole, true, false);
}

}  // namespace

IesBody parse_ies_body(const std::vector<std::string_view>& lines, std::size_t from, bool tilt_included,
                       RepairLog& log) {
  std::vector<Token> tokens = tokens_of(lines, from, true);
  if (tokens.empty()) log.fail(lines.size(), "no values after the TILT line");
  const std::vector<Token> whole = tokens_of(lines, from, false);
  bool decimals = false;
  if (whole.size() != tokens.size() && commas_are_decimals(tokens, whole, tilt_included)) {
    decimals = true;
    tokens = whole;
    log.repair(tokens.front().line, "commas read as decimal points: LM-63 has commas between values");
  }
  Cursor cursor(tokens, decimals, log);
  Head head = read_head(cursor, tilt_included, log);
  IesBody& body = head.body;
  if (tokens.size() + 3 == head.need) {
    log.repair(cursor.line(),
               "the record of ballast factor, future use and input watts is missing: 1, 1 and 0 taken");
    body.second_text = "1";
  } else {
    body.ballast_factor = cursor.number("the ballast factor");
    body.second_text = cursor.text();
    body.second_factor = cursor.number("the second value of the ballast record");
    body.input_watts = cursor.number("the input watts");
  }
  const std::size_t wanted = head.nv + head.nh + head.nv * head.nh;
  if (cursor.left() < wanted) {
    log.fail(body.first_line, "{} vertical and {} horizontal angles promise {} values, {} found", head.nv,
             head.nh, wanted, cursor.left());
  }
  body.v_line = cursor.line();
  body.v_deg = cursor.numbers(head.nv, "a vertical angle");
  body.h_line = cursor.line();
  body.h_deg = cursor.numbers(head.nh, "a horizontal angle");
  body.values_line = cursor.line();
  body.values = cursor.numbers(head.nv * head.nh, "an intensity");
  if (cursor.left() > 0) {
    log.repair(cursor.line(), "{} values left over after {} x {} intensities, from '{}': not used",
               cursor.left(), head.nh, head.nv, cursor.text().substr(0, 40));
  }
  return std::move(head.body);
}

}  // namespace lucerna
