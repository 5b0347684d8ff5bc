// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/evaluation.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/evaluation/body_shadows.h"
#include "lucerna/design/evaluation/device_evaluator.h"
#include "lucerna/design/evaluation/evaluation_sums.h"
#include "lucerna/design/evaluation/face_tracer.h"
#include "lucerna/design/evaluation/shared_sums.h"
#include "lucerna/trace/kernels/hit_kernels.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

static_assert(kBlockRays <= kHitBatch);

/// Sums of the rays of one task.
struct TaskSums {
  std::vector<double> flux;
  double weight = 0.0, reflected = 0.0, direct = 0.0, absorbed = 0.0, back = 0.0, lost = 0.0, bodies = 0.0;
  /// What of the weight has sparse derivatives.
  double derived = 0.0;
  /// Bins x coefficients, row by row; null without derivatives.
  double* jacobian = nullptr;
  std::size_t coefficients = 0;

  void ended(PathEnd end, double reflected_flux, double taken) {
    absorbed += taken;
    (end == PathEnd::direct      ? direct
     : end == PathEnd::reflected ? reflected
     : end == PathEnd::back      ? back
                                 : lost) += reflected_flux;
  }
  void add(int bin, double x) { flux[static_cast<std::size_t>(bin)] += x; }
  struct Row {
    double* at;
    void add(int coefficient, double x) const { at[coefficient] += x; }
  };
  Row row(int bin) const { return {jacobian + static_cast<std::size_t>(bin) * coefficients}; }
};

/// The same with derivatives in blocks.
struct SparseTaskSums : TaskSums {
  SparseSums* blocks = nullptr;
  std::uint32_t across = 1;

  struct Row {
    SparseSums* blocks;
    std::uint32_t bin, across;
    void add(const std::array<int, 2>& first, const SparseSums::Block& values) const {
      blocks->add(bin, static_cast<std::uint32_t>(first[1]) * across + static_cast<std::uint32_t>(first[0]),
                  values);
    }
  };
  Row row(int bin) const { return {blocks, static_cast<std::uint32_t>(bin), across}; }
};

/// Traces blocks of rays, all rays of a block one reflection at a time.
template <class Shape>
class BlockTracer {
 public:
  using Hit = typename Path<Shape>::Hit;

  BlockTracer(const EvaluationView<Shape>& view, const BodyShadows* shadows)
      : view_(view), frozen_(view), shadows_(shadows), mirror_(hit_mirror(view.shape, view.aperture)) {
    frozen_.derivatives = false;
  }

  template <class Sums>
  void add(const DesignRays::Block& block, Sums& sums) {
    follow(block);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const double weight = block.weight[i];
      sums.weight += weight;
      path_.end = paths_[i].end;
      path_.origin = paths_[i].origin;
      path_.direction = paths_[i].direction;
      path_.hits = paths_[i].hits;
      std::size_t at = paths_[i].last;
      for (int k = path_.hits; k-- > 0; at = hits_[at].before) {
        path_.hit[static_cast<std::size_t>(k)] = hits_[at].hit;
      }
      count(paths_[i], weight, sums);
    }
  }

 private:
  struct State {
    Vec3 origin, direction;
    PathEnd end = PathEnd::direct;
    int hits = 0;
    std::size_t last = 0;
    /// How often it hit a body, and the share of its light that these reflected.
    int bodies = 0;
    double share = 1.0;
  };
  struct LinkedHit {
    Hit hit;
    std::size_t before;
  };

  template <class Sums>
  void count(const State& s, double weight, Sums& sums) {
    if (s.bodies == 0) return view_.count(path_, weight, sums);
    // What the mirror absorbed before is its own.
    const double taken = weight * (1.0 - s.share), reflected_flux = view_.reflected_share(path_);
    sums.bodies += taken * reflected_flux;
    sums.absorbed += taken * (1.0 - reflected_flux);
    if (s.share > 0.0) frozen_.count(path_, weight * s.share, sums);
  }

  /// The paths of a block's rays.
  void follow(const DesignRays::Block& block) {
    hit_count_ = 0;
    std::size_t n = kBlockRays;
    for (std::size_t i = 0; i < n; ++i) {
      paths_[i] = {{block.x_mm[i], block.y_mm[i], block.z_mm[i]}, {block.kx[i], block.ky[i], block.kz[i]}};
      ray_[i] = i;
      put(i, paths_[i], 0.0, 0.0);
    }
    while (n > 0) {
      search(n);
      std::size_t left = 0;
      for (std::size_t i = 0; i < n; ++i) {
        State& s = paths_[ray_[i]];
        if (shadows_ != nullptr && hits_body(i, s)) {
          if (!body_sends_on(s)) continue;
          ray_[left] = ray_[i];
          put(left++, s, 0.0, 0.0);
        } else if (goes_on(i, s)) {
          ray_[left] = ray_[i];
          put(left++, paths_[ray_[i]], 1.0, -hits_[hit_count_ - 1].hit.m);  // reflection turns f' round
        }
      }
      n = left;
    }
  }

  void put(std::size_t i, const State& s, double on_mirror, double slope) {
    rays_.x[i] = s.origin.x;
    rays_.y[i] = s.origin.y;
    rays_.z[i] = s.origin.z;
    rays_.dx[i] = s.direction.x;
    rays_.dy[i] = s.direction.y;
    rays_.dz[i] = s.direction.z;
    rays_.on_mirror[i] = on_mirror;
    rays_.slope[i] = slope;
  }

  void search(std::size_t n) {
    if constexpr (std::is_same_v<Shape, BsplineView>) {
      kernels_.bspline(mirror_, rays_, n, ends_);
    } else {
      kernels_.revolution(mirror_, rays_, n, ends_);
    }
  }

  /// Whether a body is in the way to what the search found, and then what it leaves of the ray.
  bool hits_body(std::size_t i, State& s) {
    const std::int32_t what = ends_.what[i];
    if (what != kHitNothing && what != kHitFront && what != kHitBack) return false;
    const double t_max =
        what == kHitNothing ? static_cast<double>(std::numeric_limits<float>::max()) : ends_.t[i];
    const auto shadow = shadows_->first(s.origin, s.direction, t_max, s.hits + s.bodies > 0);
    if (!shadow) return false;
    ++s.bodies;
    s.share *= shadow->reflected;
    s.origin = shadow->origin;
    s.direction = shadow->direction;
    return true;
  }

  static bool body_sends_on(State& s) {
    if (s.bodies >= kMaxPathHits) s.share = 0.0;
    return s.share > 0.0;
  }

  bool goes_on(std::size_t i, State& s) {
    const std::int32_t what = ends_.what[i];
    if (what == kHitNothing) {
      s.end = s.hits == 0 ? PathEnd::direct : PathEnd::reflected;
      return false;
    }
    if (what != kHitFront || s.hits == kMaxPathHits) {
      s.end = what == kHitBack ? PathEnd::back : PathEnd::lost;
      return false;
    }
    if (hit_count_ == hits_.size()) hits_.resize(hits_.size() + kBlockRays);
    LinkedHit& hit = hits_[hit_count_];
    hit.before = s.last;
    reflect_path(view_.shape, ends_.t[i], s.origin, s.direction, hit.hit);
    s.last = hit_count_++;
    ++s.hits;
    return true;
  }

  const EvaluationView<Shape>& view_;
  /// The same without derivatives: for light that a body reflected.
  EvaluationView<Shape> frozen_;
  const BodyShadows* shadows_;
  decltype(hit_mirror(Shape(), std::declval<Aperture>())) mirror_;
  const HitKernels& kernels_ = best_hit_kernels();
  HitRays rays_{};
  HitEnds ends_;
  std::array<State, kBlockRays> paths_;
  std::array<std::size_t, kBlockRays> ray_;
  std::vector<LinkedHit> hits_;  ///< the first hit_count_ are of this block
  std::size_t hit_count_ = 0;
  Path<Shape> path_;
};

/// Calls `use` with what traces blocks of `rays`.
template <class Shape, class Use>
void with_tracer(const EvaluationView<Shape>& view, const DesignRays& rays, const Use& use) {
  if constexpr (std::is_same_v<Shape, BsplineView>) {
    if (rays.medium()) return use(*std::make_unique<FaceTracer>(view, *rays.medium(), rays.last_face()));
  }
  use(*std::make_unique<BlockTracer<Shape>>(view, rays.shadows()));
}

/// Jacobians that are summed apart: by the number of rays alone, so that the sums never depend on threads.
/// Each is as large as the result, so few rays get few.
std::size_t jacobian_groups(std::uint64_t rays) {
  std::size_t groups = 2;
  while (groups < kDesignTasks && rays / groups > (1u << 17)) groups *= 2;
  return groups;
}

/// The other processes' tasks, where there are any; tasks go by groups.
template <class Sums>
void share_tasks(Peers* peers, std::size_t groups, const DesignShape& design, std::size_t bins,
                 const EvaluationOptions& options, std::vector<Sums>& tasks) {
  if (peers == nullptr) return;
  const std::size_t each = tasks.size() / groups;
  const auto ends = [](TaskSums& t) {
    return std::array{&t.weight, &t.reflected, &t.direct, &t.absorbed,
                      &t.back,   &t.lost,      &t.bodies, &t.derived};
  };
  share_items(
      peers, groups, state_key(design, bins, options),
      [&](std::size_t group, std::string& bytes) {
        for (std::size_t r = group * each; r < (group + 1) * each; ++r) {
          append(bytes, tasks[r].flux);
          for (const double* sum : ends(tasks[r])) append_double(bytes, *sum);
        }
      },
      [&](std::size_t group, std::string_view& bytes) {
        for (std::size_t r = group * each; r < (group + 1) * each; ++r) {
          take(bytes, tasks[r].flux);
          for (double* sum : ends(tasks[r])) *sum = take_double(bytes);
        }
      });
}

template <class Sums>
EvaluationSums total(const std::vector<Sums>& tasks, std::size_t bins) {
  EvaluationSums sums;
  for (std::vector<double>& flux : sums.flux) flux.assign(bins, 0.0);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const TaskSums& task = tasks[t];
    std::vector<double>& stream = sums.flux[t % kDesignStreams];
    for (std::size_t b = 0; b < bins; ++b) stream[b] += task.flux[b];
    sums.weight += task.weight;
    sums.reflected += task.reflected;
    sums.direct += task.direct;
    sums.absorbed += task.absorbed;
    sums.back += task.back;
    sums.lost += task.lost;
    sums.bodies += task.bodies;
  }
  return sums;
}

template <class Shape>
Evaluation evaluate_family(const DesignShape& design, const Shape& shape, const Reflectance& reflectance,
                           const DesignRays& rays, const TentBins& bins, const EvaluationOptions& options) {
  const std::uint64_t per_task = options.rays / kBlockRays / kDesignTasks;
  const auto view = evaluation_view(shape, design.aperture(), reflectance, bins, options);
  const std::size_t groups = options.derivatives ? jacobian_groups(options.rays) : kDesignTasks;
  std::vector<std::vector<double>> jacobians(options.derivatives ? groups : 0);
  std::vector<TaskSums> sums(kDesignTasks);
  const ItemRange own = own_items(rays.peers(), groups);
  parallel_blocks(own.size(), 1, [&](std::size_t i, std::size_t) {
    const std::size_t group = own.first + i, each = kDesignTasks / groups;
    const std::size_t coefficients = shape.coefficients().size();
    if (options.derivatives) jacobians[group].assign(bins.size() * coefficients, 0.0);
    with_tracer(view, rays, [&](auto& tracer) {
      for (std::size_t r = group * each; r < (group + 1) * each; ++r) {
        sums[r].flux.assign(bins.size(), 0.0);
        if (options.derivatives) sums[r].jacobian = jacobians[group].data();
        sums[r].coefficients = coefficients;
        for (std::uint64_t b = 0; b < per_task; ++b) tracer.add(rays.block(b * kDesignTasks + r), sums[r]);
      }
    });
  });
  share_tasks(rays.peers(), groups, design, bins.size(), options, sums);
  const EvaluationSums all = total(sums, bins.size());
  Evaluation e = evaluation_of(all);
  e.rays = per_task * kDesignTasks * kBlockRays;
  if (!options.derivatives) return e;
  e.jacobian = rays.peers() == nullptr
                   ? fold_jacobians(jacobians, bins.size(), design, 1.0 / all.weight)
                   : shared_jacobian(*rays.peers(), jacobians, bins.size(), design, 1.0 / all.weight);
  return e;
}

/// How many blocks of each task have sparse derivatives; one at least.
std::uint64_t derived_blocks(const EvaluationOptions& options) {
  constexpr std::uint64_t kRound = kBlockRays * kDesignTasks;
  const std::uint64_t rays = options.derivative_rays == 0 ? options.rays : options.derivative_rays;
  return std::clamp(rays, kRound, options.rays) / kRound;
}

/// With the derivatives in blocks.
Evaluation evaluate_sparse(const DesignShape& design, const Reflectance& reflectance, const DesignRays& rays,
                           const TentBins& bins, const EvaluationOptions& options) {
  const auto& shape = std::get<BsplineShape>(design.family());
  const std::uint64_t per_task = options.rays / kBlockRays / kDesignTasks, derived = derived_blocks(options);
  const auto view = evaluation_view(shape, design.aperture(), reflectance, bins, options);
  const auto across = static_cast<std::uint32_t>(shape.row_x().intervals);
  const std::size_t groups = jacobian_groups(derived * kBlockRays * kDesignTasks),
                    each = kDesignTasks / groups;
  std::vector<SparseSums> blocks =
      sparse_sums(groups, across * static_cast<std::uint32_t>(shape.row_y().intervals));
  std::vector<SparseTaskSums> sums(kDesignTasks);
  const ItemRange own = own_items(rays.peers(), groups);
  parallel_blocks(own.size(), 1, [&](std::size_t i, std::size_t) {
    const std::size_t group = own.first + i;
    with_tracer(view, rays, [&](auto& tracer) {
      for (std::size_t r = group * each; r < (group + 1) * each; ++r) {
        sums[r].flux.assign(bins.size(), 0.0);
        sums[r].blocks = &blocks[group];
        sums[r].across = across;
        for (std::uint64_t b = 0; b < derived; ++b) tracer.add(rays.block(b * kDesignTasks + r), sums[r]);
        sums[r].derived = sums[r].weight;
      }
      blocks[group].settle();
    });
  });
  auto light_only = view;
  light_only.derivatives = false;
  parallel_blocks(derived < per_task ? own.size() * each : 0, 1, [&](std::size_t i, std::size_t) {
    const std::size_t r = own.first * each + i;
    with_tracer(light_only, rays, [&](auto& tracer) {
      for (std::uint64_t b = derived; b < per_task; ++b)
        tracer.add(rays.block(b * kDesignTasks + r), sums[r]);
    });
  });
  share_tasks(rays.peers(), groups, design, bins.size(), options, sums);
  const EvaluationSums all = total(sums, bins.size());
  Evaluation e = evaluation_of(all);
  e.rays = per_task * kDesignTasks * kBlockRays;
  if (rays.peers() != nullptr) blocks = exchanged_blocks(*rays.peers(), blocks, bins.size());
  double weight = 0.0;
  for (const TaskSums& task : sums) weight += task.derived;
  SparseDerivatives derivatives = sparse_derivatives(blocks, bins.size(), design, 1.0 / weight);
  if (rays.peers() != nullptr) share_rows(*rays.peers(), derivatives);
  e.rows.swap(derivatives.rows);
  e.rows_noise = std::move(derivatives.noise);
  return e;
}

}  // namespace

BinJacobian fold_jacobians(const std::vector<std::vector<double>>& parts, std::size_t bins,
                           const DesignShape& shape, double scale) {
  const std::vector<int>& parameter_of = shape.parameter_of();
  const std::size_t n = parameter_of.size();
  BinJacobian j =
      BinJacobian::Zero(static_cast<Eigen::Index>(bins), static_cast<Eigen::Index>(shape.parameter_count()));
  parallel_blocks(bins, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      double* row = j.data() + b * shape.parameter_count();
      for (const std::vector<double>& part : parts) {
        for (std::size_t c = 0; c < n; ++c) row[parameter_of[c]] += scale * part[b * n + c];
      }
    }
  });
  return j;
}

Evaluation evaluation_of(const EvaluationSums& sums) {
  const std::size_t bins = sums.flux.front().size();
  Evaluation e;
  e.flux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(bins));
  e.variance = e.flux;
  // Streams are independent: the variance of their mean is that of their scatter over their number.
  constexpr auto kStreams = static_cast<double>(kDesignStreams);
  for (std::size_t b = 0; b < bins; ++b) {
    double sum = 0.0, squares = 0.0;
    for (const std::vector<double>& stream : sums.flux) sum += stream[b];
    for (const std::vector<double>& stream : sums.flux)
      squares += (stream[b] - sum / kStreams) * (stream[b] - sum / kStreams);
    e.flux[static_cast<Eigen::Index>(b)] = sum / sums.weight;
    e.variance[static_cast<Eigen::Index>(b)] =
        squares * kStreams / (kStreams - 1.0) / (sums.weight * sums.weight);
  }
  e.reflected = sums.reflected / sums.weight;
  e.direct = sums.direct / sums.weight;
  e.absorbed = sums.absorbed / sums.weight;
  e.back = sums.back / sums.weight;
  e.lost = sums.lost / sums.weight;
  e.bodies = sums.bodies / sums.weight;
  return e;
}

Evaluation evaluate(const DesignShape& shape, const Reflectance& reflectance, const DesignRays& rays,
                    const TentBins& bins, const EvaluationOptions& options) {
  LUCERNA_CHECK(options.rays <= rays.size() && options.rays >= kDesignTasks * kBlockRays, "{} rays of {}",
                options.rays, rays.size());
  LUCERNA_CHECK(!rays.medium() || std::holds_alternative<BsplineShape>(shape.family()),
                "the face of a lens that is no free form");
  // Kernels for devices know no bodies.
  if (DeviceEvaluator* const device = rays.shadows() == nullptr ? rays.device() : nullptr) {
    Evaluation e = device->evaluate(shape, reflectance, rays, bins, options);
    if (!options.derivatives || !options.sparse) return e;
    e.rows = e.jacobian.sparseView();
    e.jacobian.resize(0, 0);
    return e;
  }
  if (options.derivatives && options.sparse) return evaluate_sparse(shape, reflectance, rays, bins, options);
  return std::visit(
      [&](const auto& s) { return evaluate_family(shape, s, reflectance, rays, bins, options); },
      shape.family());
}

}  // namespace lucerna
