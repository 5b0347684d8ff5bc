// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/initial/transport.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Iterations at each entropy on the way and at the last, and what it falls by from one to the next.
constexpr int kIterations = 8, kLastIterations = 24;
constexpr double kFall = 0.45;
/// Where the entropy begins: a share of the range of costs, and with a guess so many times its end.
constexpr double kFirstEntropy = 0.2, kFirstWithGuess = 6.0;
/// Scalings beyond this (and below its inverse) are absorbed into the potentials: far within a float's range.
constexpr float kMaxScaling = 1e12f;
/// Rows of the kernel that one thread works on at a time.
constexpr std::size_t kRows = 128;
/// Nearest to opposite a pair may be: 1 - d . o is at least this.
constexpr float kMinOpening = 1e-6f;

Eigen::VectorXf shares(const std::vector<DirectedFlux>& light) {
  double total = 0.0;
  for (const DirectedFlux& l : light) total += l.flux;
  LUCERNA_CHECK(total > 0.0, "transport without light");
  Eigen::VectorXf out(static_cast<Eigen::Index>(light.size()));
  for (std::size_t i = 0; i < light.size(); ++i) {
    out[static_cast<Eigen::Index>(i)] = static_cast<float>(light[i].flux / total);
  }
  return out;
}

Eigen::Matrix<float, Eigen::Dynamic, 3> vectors(const std::vector<DirectedFlux>& light) {
  Eigen::Matrix<float, Eigen::Dynamic, 3> out(static_cast<Eigen::Index>(light.size()), 3);
  for (std::size_t i = 0; i < light.size(); ++i) {
    const Direction& d = light[i].direction;
    out.row(static_cast<Eigen::Index>(i)) << static_cast<float>(d.x()), static_cast<float>(d.y()),
        static_cast<float>(d.z());
  }
  return out;
}

/// Potentials f and g of the coupling a_i b_j exp((f_i + g_j - c_ij) / e).
class Sinkhorn {
 public:
  Sinkhorn(Matrix cost, Eigen::VectorXf a, Eigen::VectorXf b, Eigen::VectorXf g)
      : cost_(std::move(cost)),
        a_(std::move(a)),
        b_(std::move(b)),
        f_(Eigen::VectorXf::Zero(a_.size())),
        g_(std::move(g)),
        kernel_(cost_.rows(), cost_.cols()) {}

  void iterate(float entropy, int iterations) {
    entropy_ = entropy;
    soften();
    absorb();
    for (int i = 0; i < iterations; ++i) {
      balance(u_, from_columns(b_.cwiseProduct(v_)));
      balance(v_, from_rows(a_.cwiseProduct(u_)));
      const float max = std::max(u_.maxCoeff(), v_.maxCoeff()), min = std::min(u_.minCoeff(), v_.minCoeff());
      if (max > kMaxScaling || min < 1.0f / kMaxScaling) absorb();
    }
    absorb();
  }
  const Eigen::VectorXf& g() const { return g_; }

 private:
  /// f from g by the soft minimum, in logarithms: right at any entropy, where the kernel could underflow.
  void soften() {
    for_rows([&](Eigen::Index i) {
      const Eigen::ArrayXf x = (g_.array() - cost_.row(i).transpose().array()) / entropy_;
      const float max = x.maxCoeff();
      f_[i] = -entropy_ * (max + std::log((b_.array() * (x - max).exp()).sum()));
    });
    u_ = Eigen::VectorXf::Ones(a_.size());
    v_ = Eigen::VectorXf::Ones(b_.size());
  }
  void absorb() {
    f_.array() += entropy_ * u_.array().log();
    g_.array() += entropy_ * v_.array().log();
    for_rows([&](Eigen::Index i) {
      kernel_.row(i) =
          ((g_.array() + f_[i] - cost_.row(i).transpose().array()) / entropy_).min(60.0f).exp().transpose();
    });
    u_.setOnes();
    v_.setOnes();
  }
  template <class Body>
  void for_rows(const Body& body) const {
    parallel_blocks(static_cast<std::size_t>(cost_.rows()), kRows, [&](std::size_t first, std::size_t last) {
      for (auto i = static_cast<Eigen::Index>(first); i < static_cast<Eigen::Index>(last); ++i) body(i);
    });
  }
  /// kernel * x and its transpose * x, in blocks of rows that are summed in order.
  Eigen::VectorXf from_columns(const Eigen::VectorXf& x) const {
    Eigen::VectorXf out(kernel_.rows());
    parallel_blocks(
        static_cast<std::size_t>(kernel_.rows()), kRows, [&](std::size_t first, std::size_t last) {
          const auto at = static_cast<Eigen::Index>(first), n = static_cast<Eigen::Index>(last - first);
          out.segment(at, n).noalias() = kernel_.middleRows(at, n) * x;
        });
    return out;
  }
  Eigen::VectorXf from_rows(const Eigen::VectorXf& x) const {
    const auto parts = parallel_map_blocks<Eigen::VectorXf>(
        static_cast<std::size_t>(kernel_.rows()), kRows, [&](std::size_t first, std::size_t last) {
          const auto at = static_cast<Eigen::Index>(first), n = static_cast<Eigen::Index>(last - first);
          return Eigen::VectorXf(kernel_.middleRows(at, n).transpose() * x.segment(at, n));
        });
    Eigen::VectorXf sum = Eigen::VectorXf::Zero(kernel_.cols());
    for (const Eigen::VectorXf& part : parts) sum += part;
    return sum;
  }
  static void balance(Eigen::VectorXf& scaling, const Eigen::VectorXf& sums) {
    for (Eigen::Index i = 0; i < sums.size(); ++i) {
      // What no light reaches yet is left to a later absorption.
      if (sums[i] > 1e-30f && sums[i] < 1e30f) scaling[i] = 1.0f / sums[i];
    }
  }

  Matrix cost_;
  Eigen::VectorXf a_, b_, f_, g_, u_, v_;
  Matrix kernel_;
  float entropy_ = 1.0f;
};

}  // namespace

PointTransport::PointTransport(const std::vector<DirectedFlux>& from, std::vector<DirectedFlux> to,
                               double sign, double entropy, const Eigen::VectorXf* guess, double ratio)
    : to_(std::move(to)),
      sign_(sign),
      entropy_(entropy),
      ratio_(static_cast<float>(ratio)),
      directions_(vectors(to_)) {
  Matrix cost = ratio_ * (vectors(from) * directions_.transpose());
  cost = (-static_cast<float>(sign)) * (1.0f - cost.array()).max(kMinOpening).log();
  const Eigen::VectorXf b = shares(to_);
  const double range = static_cast<double>(cost.maxCoeff() - cost.minCoeff());
  LUCERNA_CHECK(guess == nullptr || guess->size() == b.size(), "{} directions", b.size());
  Sinkhorn sinkhorn(std::move(cost), shares(from), b,
                    guess != nullptr ? *guess : Eigen::VectorXf::Zero(b.size()));
  const double first = guess != nullptr ? kFirstWithGuess * entropy : kFirstEntropy * range;
  for (double e = first; e > entropy; e *= kFall) sinkhorn.iterate(static_cast<float>(e), kIterations);
  sinkhorn.iterate(static_cast<float>(entropy), kLastIterations);
  dual_ = sinkhorn.g();
  potential_ = dual_.array() / static_cast<float>(entropy) + b.array().max(1e-30f).log();
}

double PointTransport::radius(const Direction& towards) const {
  const Eigen::Vector3f d(static_cast<float>(towards.x()), static_cast<float>(towards.y()),
                          static_cast<float>(towards.z()));
  const float per = static_cast<float>(sign_ / entropy_);
  const Eigen::ArrayXf x =
      potential_.array() + per * (1.0f - ratio_ * (directions_ * d).array()).max(kMinOpening).log();
  const float max = x.maxCoeff();
  const double soft =
      -entropy_ * (static_cast<double>(max) + std::log(static_cast<double>((x - max).exp().sum())));
  return std::exp(sign_ * soft);
}

}  // namespace lucerna
