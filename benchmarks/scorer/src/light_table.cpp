// SPDX-License-Identifier: Apache-2.0
#include "light_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>

namespace bench {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Lines of an LDT file, one after another, each with its number.
class LdtFile {
 public:
  explicit LdtFile(const std::string& file) : file_(file), in_(file, std::ios::binary) {
    if (!in_) throw InputError(file, "file", "nothing that can be opened", "an LDT file");
  }

  void skip(int lines) {
    for (int i = 0; i < lines; ++i) next("a line");
  }
  double number(double low, double high, const char* what) {
    std::string text = next(what);
    const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t\r");
    text = first == std::string::npos ? "" : text.substr(first, last - first + 1);
    double x = 0.0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), x);
    if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !(x >= low && x <= high))
      fail(text.empty() ? "an empty line" : text.substr(0, 60), what);
    return x;
  }
  int whole(int low, int high, const char* what) {
    const double x = number(low, high, what);
    if (x != std::floor(x)) fail(std::to_string(x), what);
    return static_cast<int>(x);
  }
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw InputError(file_, "line " + std::to_string(line_), found, expected);
  }

 private:
  std::string next(const char* what) {
    ++line_;
    std::string text;
    if (!std::getline(in_, text)) fail("the end of the file", what);
    return text;
  }

  std::string file_;
  std::ifstream in_;
  int line_ = 0;
};

/// Intensities along gamma, in both halves of the plane y = 0.
struct Halves {
  std::vector<double> gamma, c0, c180;
};

/// Which of the planes in the file are C0 and C180, by the symmetry that line 3 names.
std::array<std::size_t, 2> plane_numbers(LdtFile& in, int symmetry, const std::vector<double>& c) {
  const std::size_t count = c.size();
  const auto at = [&](double angle) -> std::size_t {
    const auto found = std::find_if(c.begin(), c.end(), [&](double x) { return std::abs(x - angle) < 1e-6; });
    if (found == c.end())
      in.fail("no plane C" + std::to_string(static_cast<int>(angle)), "planes C0 and C180");
    return static_cast<std::size_t>(found - c.begin());
  };
  if (symmetry == 1) return {0, 0};
  // The planes C0 to C180, C90 to C270, C0 to C90.
  if (symmetry == 2) return {at(0.0), at(180.0)};
  if (symmetry == 3) return {at(180.0) - count / 4, at(180.0) - count / 4};
  if (symmetry == 4) return {at(0.0), at(0.0)};
  return {at(0.0), at(180.0)};
}

std::size_t stored_planes(int symmetry, std::size_t count) {
  if (symmetry == 1) return 1;
  if (symmetry == 2 || symmetry == 3) return count / 2 + 1;
  return symmetry == 4 ? count / 4 + 1 : count;
}

std::vector<double> ascending(LdtFile& in, std::size_t count, double high, const char* what) {
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(in.number(0.0, high, what));
    if (i > 0 && !(out[i] > out[i - 1])) in.fail(std::to_string(out[i]), "an angle above the one before");
  }
  return out;
}

Halves read_halves(const std::string& file) {
  LdtFile in(file);
  in.skip(2);
  const int symmetry = in.whole(0, 4, "a symmetry from 0 to 4");
  const int planes = in.whole(1, 721, "the number of C planes, 1 to 721");
  in.skip(1);
  const int gammas = in.whole(2, 7201, "the number of gammas, 2 to 7201");
  // Distance of gammas, texts, sizes, the share that goes down.
  in.skip(1 + 5 + 10);
  if (in.number(0.0, 1000.0, "a light output ratio") != 100.0)
    in.fail("another light output ratio", "100: the table has all light");
  in.skip(2);
  in.skip(6 * in.whole(0, 20, "the number of sets of lamps, 0 to 20") + 10);
  const auto c = ascending(in, static_cast<std::size_t>(planes), 360.0, "an angle of a C plane");
  Halves out;
  out.gamma = ascending(in, static_cast<std::size_t>(gammas), 180.0, "a gamma from 0 to 180");
  const auto which = plane_numbers(in, symmetry, c);
  for (std::size_t k = 0; k < stored_planes(symmetry, c.size()); ++k) {
    std::vector<double> row;
    for (int i = 0; i < gammas; ++i) row.push_back(in.number(0.0, 1e12, "an intensity of 0 or more"));
    if (k == which[0]) out.c0 = row;
    if (k == which[1]) out.c180 = row;
  }
  return out;
}

class LightTable : public Source {
 public:
  LightTable(const std::string& file, const Halves& halves) {
    for (std::size_t i = halves.gamma.size(); i-- > 0;) add(-halves.gamma[i], halves.c180[i]);
    for (std::size_t i = 0; i < halves.gamma.size(); ++i) add(halves.gamma[i], halves.c0[i]);
    below_.push_back(0.0);
    for (std::size_t i = 1; i < angle_.size(); ++i)
      below_.push_back(below_.back() + 0.5 * (light_[i - 1] + light_[i]) * (angle_[i] - angle_[i - 1]));
    if (!(below_.back() > 0.0)) throw InputError(file, "intensities", "no light", "a table with light");
  }

  SourceRay ray(std::uint64_t, RayRandom& random) const override {
    const double angle = kDegree * angle_at(random.uniform() * below_.back());
    return {{}, {std::sin(angle), 0.0, -std::cos(angle)}, 1.0};
  }

 private:
  void add(double angle, double light) {
    angle_.push_back(angle);
    light_.push_back(light);
  }

  /// Where so much of the light is below.
  double angle_at(double below) const {
    const auto above = std::upper_bound(below_.begin(), below_.end(), below);
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(above - below_.begin()), below_.size() - 1);
    const double width = angle_[i] - angle_[i - 1], a = light_[i - 1], b = light_[i];
    const double rest = below - below_[i - 1];
    if (width <= 0.0) return angle_[i];
    // a x + (b - a) x^2 / (2 width) = rest, in the form that needs no division by b - a.
    const double root = std::sqrt(std::max(0.0, a * a + 2.0 * (b - a) / width * rest));
    return angle_[i - 1] + std::min(width, a + root > 0.0 ? 2.0 * rest / (a + root) : 0.0);
  }

  std::vector<double> angle_, light_, below_;
};

}  // namespace

std::unique_ptr<Source> read_light_table(const std::string& file) {
  return std::make_unique<LightTable>(file, read_halves(file));
}

}  // namespace bench
