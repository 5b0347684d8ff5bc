// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solid_flight.h"

namespace lucerna {

void SolidFlight::set_out() {
  n_ = which_.size();
  random_.reserve(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    const GlassRay& r = rays_[which_[i]];
    number_[i] = i;
    random_.push_back(solid_random(r.key));
    put_ray(solid_.solid_from_world.ray(r.ray), i, batch_);
    batch_.part[i] = r.hit.part;
    batch_.t[i] = r.hit.t_mm, batch_.u[i] = r.hit.u, batch_.v[i] = r.hit.v;
  }
}

void SolidFlight::enter() {
  for (std::size_t i = 0; i < n_; ++i) batch_.chance[i] = random_[i].uniform();
  kernels_->enter(n_, batch_);
  for (std::size_t i = 0; i < n_; ++i) {
    passage(i) = {};
    passage(i).throughput = 1.0;
    passage(i).transmitted = batch_.inside[i] > 0.0;
  }
}

void SolidFlight::cross() {
  for (std::size_t i = 0; i < n_; ++i) {
    const MediumView& medium = media_[number_[i]];
    const bool inside = batch_.inside[i] > 0.0;
    if (inside) passage(i).throughput *= std::exp(-medium.absorption_per_mm * batch_.t[i]);
    batch_.ratio[i] = inside ? 1.0 / medium.index : medium.index;
    batch_.chance[i] = random_[number_[i]].uniform();
  }
  kernels_->cross_boundaries(n_, batch_);
  std::size_t stay = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    if (!(batch_.behind[i] > 0.0)) {
      if (!(batch_.reflected[i] > 0.0)) {
        batch_.inside[i] = 1.0 - batch_.inside[i];
        passage(i).transmitted = true;
      }
      if (solid_.finish.scatters_at({batch_.part[i]})) scatter(i);
      if (!(batch_.inside[i] > 0.0)) {
        finish(i);
        continue;
      }
    }
    move(i, stay++);
  }
  n_ = stay;
}

void SolidFlight::scatter(std::size_t i) {
  const std::size_t number = number_[i];
  PolarisedRay light{ray_of(batch_, i), {batch_.fx[i], batch_.fy[i], batch_.fz[i]}};
  const Direction normal = Direction::from_unit({batch_.hx[i], batch_.hy[i], batch_.hz[i]});
  const double index = batch_.inside[i] > 0.0 ? media_[number].index : 1.0;
  scatter_on(solid_.finish.lobes, normal, outward_of(batch_, i), index, random_[number], light);
  const Vec3& d = light.ray.direction.vec();
  batch_.dx[i] = d.x, batch_.dy[i] = d.y, batch_.dz[i] = d.z;
  batch_.fx[i] = light.field.x, batch_.fy[i] = light.field.y, batch_.fz[i] = light.field.z;
}

void SolidFlight::drop_lost() {
  std::size_t stay = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    if (batch_.part[i] < 0) {
      lose(i);
    } else {
      move(i, stay++);
    }
  }
  n_ = stay;
}

void SolidFlight::lose(std::size_t i) {
  finish(i);
  passage(i).lost = true;
}

void SolidFlight::move(std::size_t from, std::size_t to) {
  if (from == to) return;
  SolidBatch& b = batch_;
  for (auto* const array : {b.ox, b.oy, b.oz, b.dx, b.dy, b.dz, b.fx, b.fy, b.fz, b.t, b.u, b.v, b.inside})
    array[to] = array[from];
  b.part[to] = b.part[from];
  number_[to] = number_[from];
}

}  // namespace lucerna
