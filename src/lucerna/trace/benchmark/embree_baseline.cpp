// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/benchmark/benchmark.h"
#include "lucerna/trace/kernels/kernel.h"

#if defined(LUCERNA_EMBREE)
#include <pmmintrin.h>
#include <xmmintrin.h>

#include "lucerna/trace/engines/embree_device.h"
#endif

namespace lucerna {

#if defined(LUCERNA_EMBREE)

struct EmbreeBaseline::Device {
  explicit Device(const HeightField& field) {
    csr_ = _mm_getcsr();  // Embree's manual asks for these modes; they are this thread's until the end
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    RTCGeometry mesh = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto n = static_cast<std::size_t>(field.cells()) + 1;
    auto* v = static_cast<float*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, n * n));
    auto* t = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 2 * (n - 1) * (n - 1)));
    for (std::size_t i = 0; i < n * n; ++i) {
      const double x =
          field.region().x0_mm + static_cast<double>(i % n) * static_cast<double>(field.step_x_mm());
      const double y =
          field.region().y0_mm + static_cast<double>(i / n) * static_cast<double>(field.step_y_mm());
      v[3 * i] = static_cast<float>(x);
      v[3 * i + 1] = static_cast<float>(y);
      v[3 * i + 2] =
          static_cast<float>(field.quadric().at(x, y).z_mm + static_cast<double>(field.vertices()[i].z_mm));
    }
    for (std::size_t y = 0; y + 1 < n; ++y) {
      for (std::size_t x = 0; x + 1 < n; ++x) {
        const auto a = static_cast<unsigned>(y * n + x), b = static_cast<unsigned>(a + n);
        for (const unsigned k : {a, a + 1, b + 1, a, b + 1, b}) *t++ = k;
      }
    }
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_.get(), mesh);
    rtcReleaseGeometry(mesh);
    build_s = wall_seconds([&] { rtcCommitScene(scene_.get()); });
  }
  ~Device() { _mm_setcsr(csr_); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// All rays, at most `bounces` reflections; bins at one degree.
  void trace(const RayBlock& source, double lift_mm, int bounces, std::span<double> bins) const {
    const Kernels& kernels = best_kernels();
    const FrameView lifted{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, static_cast<float>(lift_mm)}};
    auto batch = std::make_unique<Batch>();
    std::fill(std::begin(batch->throughput), std::end(batch->throughput), 0.9);
    for (std::size_t first = 0; first < source.size(); first += kBatch) {
      std::size_t n = std::min(kBatch, source.size() - first);
      const RayArrays arrays{&source.x_mm[first],  &source.y_mm[first], &source.z_mm[first],
                             &source.kx[first],    &source.ky[first],   &source.kz[first],
                             &source.weight[first]};
      bool all_finite = true;
      kernels.enter(lifted, arrays, n, 1.0, batch->rays, all_finite);
      batch->out_count = 0;
      for (int bounce = 0; n > 0; ++bounce) n = step(kernels, *batch, n, bounce, bounces);
      kernels.far_field_cells(batch->out, batch->out_count, 360, 181, batch->number);
      for (std::size_t i = 0; i < batch->out_count; ++i)
        bins[static_cast<std::size_t>(batch->number[i])] += static_cast<double>(batch->out.flux[i]);
    }
  }

  /// What one batch of rays needs: all but the search for hits is done by the kernels that our tracer uses
  /// too.
  struct Batch {
    WorldRays rays, out;
    LocalRays local;
    LocalHits hits;
    std::size_t out_count = 0;
    alignas(64) float cosine[kBatch];
    alignas(64) double throughput[kBatch];
    /// Of reflections, then of far-field cells.
    alignas(64) std::int32_t number[kBatch];
    alignas(64) std::int32_t status[kBatch];
  };

  std::size_t step(const Kernels& kernels, Batch& batch, std::size_t n, int bounce, int bounces) const {
    const FrameView same{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    kernels.to_local(same, batch.rays, n, 0, batch.local);
    for (std::size_t i = 0; i < n; i += 16) intersect(batch.local, i, n, batch.hits);
    std::fill_n(batch.number, n, bounce);
    std::fill_n(batch.status, n, kEscaped);
    kernels.reflect(same, batch.local, batch.hits, n, batch.rays, batch.cosine);
    kernels.resolve_hits(batch.hits, batch.number, bounces, batch.throughput, 0, n, batch.rays.flux,
                         batch.status);
    return kernels.compact(batch.rays, batch.status, n, batch.out, batch.out_count);
  }

  /// First hits of rays i .. i + 15.
  void intersect(const LocalRays& rays, std::size_t i, std::size_t n, LocalHits& hits) const {
    alignas(64) RTCRayHit16 packet;
    alignas(64) int valid[16];
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t k = 0; k < 16; ++k) {
      valid[k] = i + k < n ? -1 : 0;
      packet.ray.org_x[k] = rays.x[i + k];
      packet.ray.org_y[k] = rays.y[i + k];
      packet.ray.org_z[k] = rays.z[i + k];
      packet.ray.dir_x[k] = rays.dx[i + k];
      packet.ray.dir_y[k] = rays.dy[i + k];
      packet.ray.dir_z[k] = rays.dz[i + k];
      packet.ray.tnear[k] = rays.on_mirror[i + k] != 0 ? 1e-3F : 0.0F;
      packet.ray.tfar[k] = 1e18F;
      packet.ray.time[k] = 0.0F;
      packet.ray.mask[k] = 0xFFFFFFFFU;
      packet.ray.flags[k] = 0;
      packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect16(valid, scene_.get(), &context, &packet);
    for (std::size_t k = 0; k < 16; ++k) {
      const bool is_hit = valid[k] != 0 && packet.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
      hits.t[i + k] = hits.past[i + k] = packet.ray.tfar[k];
      hits.start[i + k] = 0.0F;
      const float per = is_hit ? -1.0F / packet.hit.Ng_z[k] : 0.0F;
      hits.gx[i + k] = packet.hit.Ng_x[k] * per;
      hits.gy[i + k] = packet.hit.Ng_y[k] * per;
      hits.gz[i + k] = 1.0F;
      const float towards = -packet.hit.Ng_x[k] * per * rays.dx[i + k] -
                            packet.hit.Ng_y[k] * per * rays.dy[i + k] + rays.dz[i + k];
      hits.state[i + k] = !is_hit ? kMiss : towards < 0.0F ? kFront : kBack;
    }
  }

  double build_s = 0.0;
  unsigned csr_ = 0;
  EmbreeDevice device_{"threads=1"};
  EmbreeScene scene_{device_};
};

bool EmbreeBaseline::available() { return true; }

EmbreeBaseline::EmbreeBaseline(const HeightField& field)
    : device_(std::make_unique<Device>(field)), build_s_(device_->build_s) {}

void EmbreeBaseline::trace(const RayBlock& rays, double lift_mm, int bounces, std::span<double> bins) const {
  LUCERNA_CHECK(bins.size() == std::size_t{360} * 181, "{} bins", bins.size());
  device_->trace(rays, lift_mm, bounces, bins);
}

#else

struct EmbreeBaseline::Device {};

bool EmbreeBaseline::available() { return false; }

EmbreeBaseline::EmbreeBaseline(const HeightField&) {
  throw InputError("this program was built without Embree");
}

void EmbreeBaseline::trace(const RayBlock&, double, int, std::span<double>) const {}

#endif

EmbreeBaseline::~EmbreeBaseline() = default;

}  // namespace lucerna
