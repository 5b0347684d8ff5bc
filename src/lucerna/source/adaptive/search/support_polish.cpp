// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/search/support_polish.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/source/adaptive/search/support_moves.h"

namespace lucerna {

namespace {

constexpr int kSweeps = 2;
/// The score shall fall by so much to both sides, nats: above the roughness, within the parabola.
constexpr double kMinDrop = 0.006, kMaxDrop = 0.03;
constexpr int kMaxScalings = 3;
constexpr double kWorthNats = 4.0;

/// a + b t + c t^2.
struct Parabola {
  double a = 0.0, b = 0.0, c = 0.0;

  /// The least squares through (-1, low[0]), (-1/2, low[1]), (0, middle), (1/2, high[1]), (1, high[0]).
  static Parabola through(const std::array<double, 2>& low, double middle,
                          const std::array<double, 2>& high) {
    Parabola p;
    p.b = (high[0] - low[0] + 0.5 * (high[1] - low[1])) / 2.5;
    // With u = t^2: u = 1, 1/4, 0, 1/4, 1, whose mean is 1/2 and sum of squared differences 7/8.
    const double mean = (low[0] + low[1] + middle + high[1] + high[0]) / 5.0;
    p.c = (0.5 * (low[0] + high[0]) - 0.25 * (low[1] + high[1]) - 0.5 * middle) / 0.875;
    p.a = mean - 0.5 * p.c;
    return p;
  }
  /// Where it is largest, within one and a half steps.
  double vertex() const { return c < 0.0 ? std::clamp(-0.5 * b / c, -1.5, 1.5) : 0.0; }
  double gain(double t) const { return t * (b + t * c); }
};

struct Polisher {
  const HeldOutScorer& scorer;
  double length_mm, angle;
  SupportScore best;
  /// Steps of each move, in units of the first.
  std::array<double, kSupportMoves> step{};

  std::optional<Support> at(int move, double t) const {
    return moved(best.on.support, move, t * length_mm, t * angle);
  }

  /// Scores at -t and t; nothing if the move does not exist there.
  std::optional<std::array<double, 2>> sides(int move, double t) const {
    const auto low = at(move, -t), high = at(move, t);
    if (!low || !high) return std::nullopt;
    const auto scores = scorer.scores({*low, *high});
    return std::array<double, 2>{scores[0].nats, scores[1].nats};
  }

  /// Whether anything changed.
  bool improve(int move) {
    double& t = step[static_cast<std::size_t>(move)];
    std::optional<std::array<double, 2>> wide, narrow;
    for (int scaling = 0; scaling <= kMaxScalings; ++scaling) {
      if (!wide) wide = sides(move, t);
      if (!wide) return false;
      const double drop = best.nats - 0.5 * ((*wide)[0] + (*wide)[1]);
      const bool last = scaling == kMaxScalings;
      if (drop < kMinDrop && !last) {
        narrow = wide, wide.reset(), t *= 2.0;
      } else if (drop > kMaxDrop && !last) {
        if (narrow) break;  // between the two
        wide = sides(move, 0.5 * t), t *= 0.5;
      } else {
        break;
      }
    }
    if (!narrow) narrow = sides(move, 0.5 * t);
    if (!narrow || !wide) return false;
    const auto p = Parabola::through({(*wide)[0], (*narrow)[0]}, best.nats, {(*wide)[1], (*narrow)[1]});
    const double vertex = p.vertex();
    if (p.gain(vertex) * static_cast<double>(best.log_density.size()) < kWorthNats) return false;
    const auto better = at(move, vertex * t);
    if (better) best = scorer.score(*better);
    return better.has_value();
  }
};

}  // namespace

SupportScore polish_support(const HeldOutScorer& scorer, const Support& start, double length_mm, double angle,
                            Progress& progress) {
  Polisher polisher{scorer, length_mm, angle, scorer.score(start)};
  polisher.step.fill(1.0);
  // What was well placed at first is left alone the second time.
  std::array<bool, kSupportMoves> again;
  again.fill(true);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int move = 0; move < kSupportMoves; ++move) {
      if (progress.stop_requested()) throw Interrupted();
      bool& wanted = again[static_cast<std::size_t>(move)];
      wanted = wanted && polisher.improve(move);
    }
  }
  return scorer.tightened(polisher.best);
}

}  // namespace lucerna
