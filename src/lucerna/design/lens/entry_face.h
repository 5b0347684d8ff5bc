// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/lens/free_face.h"
#include "lucerna/design/lens/lens_limits.h"

namespace lucerna {

// The face by which light comes into a lens whose last face is a free form: as a cavity, an ellipsoid of
// revolution from the plane of the base up, its upper half or, with a draft, a cap of it; or as a free form
// too.

/// A cavity by its radius and depth; without depth the base is flat.
struct Cavity {
  double radius_mm = 0.0, depth_mm = 0.0;
};

/// What cavities a lens may have.
struct CavityRange {
  double max_radius_mm = 0.0, max_depth_mm = 0.0;
};

/// Throws InputError where the face opposite to the free one does not lead from the axis to a base or the
/// wall.
CavityRange cavity_range(const LensShape& lens, const LensLimits& limits);

/// The lens with a cavity in the place of the face opposite to its free face, which is lifted where the
/// cavity would cut it. Throws InputError for one that does not fit, or is too deep for its draft.
LensShape with_cavity(const LensShape& lens, const Cavity& cavity, double min_draft_deg = 0.0);

/// The first face of the lens as a free form in a design's frame, as near to what it is as the knots allow:
/// it covers what that covers, but for a ring beside the base's edge. Throws InputError as cavity_range does.
DesignShape entry_of(const LensShape& lens, const LensLimits& limits, int intervals);

/// The seat of the last face over such a first one.
FaceSeat seat_over(const LensShape& lens, const DesignShape& entry);

/// Where a source ends: its lowest place in a design's frame, and its farthest from the axis.
struct SourceEnd {
  double low_mm = std::numeric_limits<double>::infinity(), radius_mm = 0.0;
};
/// By where rays of a design begin. O(rays).
SourceEnd source_end(const DesignRays& rays);

/// The limits on the first face below the last one, on so many circles: between them there is
/// `min_thickness_mm`, and the first stays above the base's plane and above the source.
ShapeLimits entry_limits(const LensLimits& limits, const LensShape& lens, const DesignShape& entry,
                         const DesignShape& last, const SourceEnd& source, int rings);

/// Brings rays of a design into the lens by its first face; rays that miss it are lost.
DesignRays::Pass into_entry(const DesignShape& entry, const MediumView& medium);

/// Whether more of the rays (in the lens's frame) begin in the medium than with the given lens: such a base
/// is none.
bool takes_source_in(const LensShape& lens, const LensShape& given, const DesignRays& rays);

}  // namespace lucerna
