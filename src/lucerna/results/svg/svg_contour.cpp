// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// The crossings of one level with the grid's edges, and which of them a segment joins. The edge from
/// (ix, iy) to the right has the number 2 (iy nx + ix), the one to the next row that plus 1.
class Crossings {
 public:
  Crossings(const SampledField& field, double level)
      : f_(field), level_(level), next_(2 * field.value.size(), {kNone, kNone}) {
    for (std::size_t iy = 0; iy + 1 < f_.y.size(); ++iy) {
      for (std::size_t ix = 0; ix + 1 < f_.x.size(); ++ix) add_cell(ix, iy);
    }
  }

  std::vector<std::vector<SvgPoint>> lines() {
    std::vector<std::vector<SvgPoint>> result;
    // Open lines first, from an end; what is left are loops.
    for (const bool open : {true, false}) {
      for (std::size_t edge = 0; edge < next_.size(); ++edge) {
        if (next_[edge][0] == kNone || (open && next_[edge][1] != kNone)) continue;
        result.push_back(follow(edge));
      }
    }
    return result;
  }

 private:
  std::size_t index(std::size_t ix, std::size_t iy) const { return iy * f_.x.size() + ix; }
  bool inside(std::size_t ix, std::size_t iy) const { return f_.value[index(ix, iy)] >= level_; }

  SvgPoint place(std::size_t edge) const {
    const std::size_t at = edge / 2, ix = at % f_.x.size(), iy = at / f_.x.size();
    const bool down = edge % 2 == 1;
    const double a = f_.value[at], b = f_.value[down ? at + f_.x.size() : at + 1];
    const double t = (level_ - a) / (b - a);
    return down ? SvgPoint{f_.x[ix], f_.y[iy] + t * (f_.y[iy + 1] - f_.y[iy])}
                : SvgPoint{f_.x[ix] + t * (f_.x[ix + 1] - f_.x[ix]), f_.y[iy]};
  }

  void join(std::size_t a, std::size_t b) {
    next_[a][next_[a][0] == kNone ? 0 : 1] = b;
    next_[b][next_[b][0] == kNone ? 0 : 1] = a;
  }

  void add_cell(std::size_t ix, std::size_t iy) {
    const std::array<bool, 4> in{inside(ix, iy), inside(ix + 1, iy), inside(ix + 1, iy + 1),
                                 inside(ix, iy + 1)};
    // Edges between corners 0-1, 1-2, 2-3, 3-0.
    const std::array<std::size_t, 4> edge{2 * index(ix, iy), 2 * index(ix + 1, iy) + 1, 2 * index(ix, iy + 1),
                                          2 * index(ix, iy) + 1};
    std::array<std::size_t, 4> crossed{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (in[i] != in[(i + 1) % 4]) crossed[n++] = edge[i];
    }
    if (n == 2) join(crossed[0], crossed[1]);
    if (n != 4) return;
    const double mean = 0.25 * (f_.value[index(ix, iy)] + f_.value[index(ix + 1, iy)] +
                                f_.value[index(ix + 1, iy + 1)] + f_.value[index(ix, iy + 1)]);
    // The corners that differ from the centre are cut off, each by its own segment.
    if (in[0] == (mean >= level_)) {
      join(edge[0], edge[1]);
      join(edge[2], edge[3]);
    } else {
      join(edge[3], edge[0]);
      join(edge[1], edge[2]);
    }
  }

  /// The line from `edge` on; clears it.
  std::vector<SvgPoint> follow(std::size_t edge) {
    std::vector<SvgPoint> line;
    const std::size_t start = edge;
    const bool loop = next_[edge][1] != kNone;
    std::size_t before = kNone;
    while (edge != kNone) {
      line.push_back(place(edge));
      std::array<std::size_t, 2>& links = next_[edge];
      const std::size_t on = links[0] == before && before != kNone ? links[1] : links[0];
      links = {kNone, kNone};
      before = edge;
      edge = on != kNone && next_[on][0] == kNone ? kNone : on;
    }
    if (loop) line.push_back(place(start));
    return line;
  }

  const SampledField& f_;
  double level_;
  std::vector<std::array<std::size_t, 2>> next_;
};

void check(const SampledField& f) {
  LUCERNA_CHECK(f.x.size() > 1 && f.y.size() > 1 && f.value.size() == f.x.size() * f.y.size(),
                "{} x {} samples, {} values", f.x.size(), f.y.size(), f.value.size());
}

double distance(SvgPoint a, SvgPoint b) { return std::hypot(b.x - a.x, b.y - a.y); }

}  // namespace

std::vector<std::vector<SvgPoint>> contour_lines(const SampledField& field, double level) {
  check(field);
  return Crossings(field, level).lines();
}

std::vector<std::vector<SvgPoint>> contour_rings(const SampledField& field, double level) {
  check(field);
  // One more row and column all round, at the border's own place and below the level.
  const std::size_t nx = field.x.size(), ny = field.y.size();
  SampledField padded;
  const auto extended = [](const std::vector<double>& v) {
    std::vector<double> out{v.front()};
    out.insert(out.end(), v.begin(), v.end());
    out.push_back(v.back());
    return out;
  };
  padded.x = extended(field.x);
  padded.y = extended(field.y);
  padded.value.assign((nx + 2) * (ny + 2), level - std::max(1.0, std::abs(level)));
  for (std::size_t iy = 0; iy < ny; ++iy) {
    std::copy_n(field.value.begin() + static_cast<std::ptrdiff_t>(iy * nx), nx,
                padded.value.begin() + static_cast<std::ptrdiff_t>((iy + 1) * (nx + 2) + 1));
  }
  return Crossings(padded, level).lines();
}

std::vector<SvgPoint> thinned(const std::vector<SvgPoint>& line, double tolerance) {
  if (line.size() < 3) return line;
  std::vector<bool> retained(line.size(), false);
  retained.front() = retained.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, line.size() - 1}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const SvgPoint p = line[a], q = line[b];
    const double length = distance(p, q);
    std::size_t farthest = a;
    double max = tolerance;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double off =
          length > 0.0 ? std::abs((q.x - p.x) * (line[i].y - p.y) - (q.y - p.y) * (line[i].x - p.x)) / length
                       : distance(p, line[i]);
      if (off > max) max = off, farthest = i;
    }
    if (farthest == a) continue;
    retained[farthest] = true;
    open.push_back({a, farthest});
    open.push_back({farthest, b});
  }
  std::vector<SvgPoint> out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (retained[i]) out.push_back(line[i]);
  }
  return out;
}

std::vector<std::vector<SvgPoint>> thinned(std::vector<std::vector<SvgPoint>> rings, double tolerance) {
  for (auto& ring : rings) ring = thinned(ring, tolerance);
  return rings;
}

void LineLabels::write(SvgCanvas& canvas, const std::vector<SvgPoint>& line, const std::string& text,
                       double along, double min_length) {
  constexpr double kHeight = 13.0, kGap = 3.0;
  std::vector<double> gone{0.0};
  for (std::size_t i = 1; i < line.size(); ++i) gone.push_back(gone.back() + distance(line[i - 1], line[i]));
  if (gone.back() < min_length) return;
  const double width = 6.2 * static_cast<double>(text.size()) + 4.0;
  const auto free = [&](SvgPoint p) {
    return std::ranges::none_of(taken_, [&](const Box& b) {
      return std::abs(b.centre.x - p.x) < 0.5 * (b.width + width) + kGap &&
             std::abs(b.centre.y - p.y) < 0.5 * (b.height + kHeight) + kGap;
    });
  };
  // 0, +1, -1, +2, ... twentieths from the place wanted.
  for (int k = 0; k < 20; ++k) {
    const double share = along + 0.05 * (k % 2 == 1 ? k / 2 + 1 : -(k / 2));
    if (share < 0.0 || share > 1.0) continue;
    const auto at = std::ranges::lower_bound(gone, share * gone.back());
    const SvgPoint p = line[std::min(line.size() - 1, static_cast<std::size_t>(at - gone.begin()))];
    if (!free(p)) continue;
    taken_.push_back({p, width, kHeight});
    canvas.rectangle({p.x - 0.5 * width, p.y - 7.0}, width, kHeight, {.fill = "#fff", .opacity = 0.85});
    canvas.text({p.x, p.y + 3.5}, text, {.size = 10.5, .anchor = "middle"});
    return;
  }
}

}  // namespace lucerna
