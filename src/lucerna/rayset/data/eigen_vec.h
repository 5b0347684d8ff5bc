// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lucerna/geometry.h"

namespace lucerna {

inline Vec3 to_vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d to_eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace lucerna
