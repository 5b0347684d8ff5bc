// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/project_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna {

namespace {

constexpr KeyRange kAny{};
constexpr KeyRange kAboveZero{.min = 0.0, .min_excluded = true};
constexpr KeyRange kNotNegative{.min = 0.0};
constexpr KeyRange kShare{.min = 0.0, .max = 1.0};

constexpr KeyRange within(double min, double max) { return {.min = min, .max = max}; }
constexpr KeyRange whole(double min, double max) { return {.min = min, .max = max, .whole = true}; }
/// (0, max], or (0, max) with `excluded`.
constexpr KeyRange up_to(double max, bool excluded = false) {
  return {.min = 0.0, .max = max, .min_excluded = true, .max_excluded = excluded};
}

using Type = KeyType;

// clang-format off
constexpr std::array kKeys{
    // table, key, type, range, words, default, meaning
    ProjectKey{"", "source", Type::tables, kAny, "", "required", "The light sources. Their fluxes add."},
    ProjectKey{"", "reflector", Type::tables, kAny, "", "none", "The mirrors."},
    ProjectKey{"", "body", Type::tables, kAny, "", "none", "Housings, lamp bodies, sheets, cover glasses, lenses."},
    ProjectKey{"", "detector", Type::tables, kAny, "", "one far field", "What is recorded."},
    ProjectKey{"", "target", Type::table, kAny, "", "none", "What a design is to reach. `trace` does not read it."},
    ProjectKey{"", "design", Type::table, kAny, "", "none", "How a design is found. `trace` does not read it."},

    ProjectKey{"source", "file", Type::file, kAny, "", "none", "A ray file or a source model (`.nfl`). A source has either `file` or `kind`."},
    ProjectKey{"source", "kind", Type::word, kAny, "point disk rectangle cylinder sphere filament led phong500 phong25 radial cosine", "none", "An analytic emitter."},
    ProjectKey{"source", "flux_lm", Type::number, kAboveZero, "", "of the file, which must state one; 1000 for a kind", "Luminous flux. Excludes `flux_w`; the unit must be the file's."},
    ProjectKey{"source", "flux_w", Type::number, kAboveZero, "", "of the file", "Radiant flux."},
    ProjectKey{"source", "radius_mm", Type::number, kAboveZero, "", "1; filament 0.6; radial, cosine, phong 10", "Radius of a disk, cylinder, sphere, of a filament's coil, of the sphere of the synthetic sets."},
    ProjectKey{"source", "length_mm", Type::number, kAboveZero, "", "6; filament 8", "Length of a cylinder or filament."},
    ProjectKey{"source", "size_mm", Type::numbers, kAboveZero, "", "[1, 1]", "Sides of a rectangle."},
    ProjectKey{"source", "ghost_share", Type::number, {.min = 0.0, .max = 1.0, .max_excluded = true}, "", "0.05", "Share of a filament's flux that its image in the bulb has."},
    ProjectKey{"source", "surface", Type::word, kAny, "none plane sphere cylinder box", "led, filament: sphere; else none", "The surface that an emitter's rays are given on."},
    ProjectKey{"source", "surface_mm", Type::number_or_numbers, kAny, "", "led 3, filament 20", "Its sizes: radius of a sphere; radius and length of a cylinder; sides [x, y, z] of a box; height of a plane."},
    ProjectKey{"source", "wavelength_nm", Type::number, within(100, 20000), "", "of the file", "The one wavelength of all rays. Only solids with `dispersion` ask for it."},
    ProjectKey{"source", "spectrum", Type::file, kAny, "", "of the file", "A table (CSV) that the rays' wavelengths are drawn from: nm and relative spectral power, a line each, linear between them."},
    ProjectKey{"source", "position_mm", Type::vector, kAny, "", "[0, 0, 0]", "Where the source's origin is placed."},
    ProjectKey{"source", "axis", Type::axis, kAny, "", "\"+z\"", "Where the source's +z axis points."},
    ProjectKey{"source", "turn_deg", Type::number, kAny, "", "0", "Rotation about that axis."},

    ProjectKey{"reflector", "family", Type::word, kAny, "revolution trough bspline faceted heightmap mesh", "required", "How the surface is described."},
    ProjectKey{"reflector", "preset", Type::word, kAny, "parabola ellipse hyperbola", "none", "A conic (revolution, trough, faceted). One of `preset`, `profile_mm`, `file`."},
    ProjectKey{"reflector", "focal_mm", Type::number, kAboveZero, "", "required with a preset and for bspline", "Distance of the focus from the vertex."},
    ProjectKey{"reflector", "focal2_mm", Type::number, kAboveZero, "", "required for ellipse, hyperbola", "Distance of the second focus from the vertex."},
    ProjectKey{"reflector", "mouth_diameter_mm", Type::number, kAboveZero, "", "none", "An ellipsoid that continues past its equator ends at a mouth of this diameter."},
    ProjectKey{"reflector", "profile_mm", Type::pairs, kAny, "", "none", "Points [r, z] from the vertex to the rim; a spline goes through them."},
    ProjectKey{"reflector", "file", Type::file, kAny, "", "none", "A profile (lines r, z), sampled heights (heightmap: .csv .txt .npy .pgm .png) or a mesh (.stl .obj)."},
    ProjectKey{"reflector", "pitch_mm", Type::number, kAboveZero, "", "required for faceted", "Side of a facet."},
    ProjectKey{"reflector", "pillow_radius_mm", Type::number, kAny, "", "flat facets", "Radius of curvature of a facet."},
    ProjectKey{"reflector", "intervals", Type::numbers, whole(1, 1000), "", "[4, 4]", "Intervals between the knots of a bspline along x and y."},
    ProjectKey{"reflector", "coefficients_mm", Type::numbers, kAny, "", "all 0", "Heights of a bspline over its paraboloid: (intervals + 3) in each direction, x first."},
    ProjectKey{"reflector", "aperture", Type::word, kAny, "circle rectangle", "circle; heightmap: rectangle", "Outline of the mirror."},
    ProjectKey{"reflector", "diameter_mm", Type::number, kAboveZero, "", "required for a circle; of the profile or heights where there are any", "Diameter of a circular aperture."},
    ProjectKey{"reflector", "size_mm", Type::numbers, kAboveZero, "", "required for a rectangle and for heightmap", "Sides [x, y] of a rectangular aperture; of a heightmap from its first to its last sample."},
    ProjectKey{"reflector", "hole_diameter_mm", Type::number, kNotNegative, "", "0", "A hole about the vertex."},
    ProjectKey{"reflector", "z_scale_mm", Type::number, kAny, "", "1; required for pictures", "Height that one unit of a heightmap's numbers, or one grey level, represents."},
    ProjectKey{"reflector", "z_offset_mm", Type::number, kAny, "", "0", "Height of a heightmap's zero."},
    ProjectKey{"reflector", "first_row", Type::word, kAny, "top bottom", "\"top\"", "Whether a heightmap's first row is at +y or at -y."},
    ProjectKey{"reflector", "scale", Type::number, kAboveZero, "", "1", "Millimetres of one unit of a mesh."},
    ProjectKey{"reflector", "smooth_normals", Type::flag, kAny, "", "false", "A mesh reflects as the curved surface that it represents."},
    ProjectKey{"reflector", "crease_deg", Type::number, up_to(180), "", "30", "With `smooth_normals`: edges with a larger angle stay sharp."},
    ProjectKey{"reflector", "name", Type::text, kAny, "", "the file's name", "A mesh's name in the energy balance."},
    ProjectKey{"reflector", "reflectance", Type::number_or_pairs, kAny, "", "1", "Share of light that is reflected, 0 to 1; or [[angle of incidence in degrees, share], ...]."},
    ProjectKey{"reflector", "metal", Type::word, kAny, "aluminium silver", "none", "Instead of `reflectance`: that of a smooth film without a coat, over the angle of incidence ([materials](../theory/materials.md))."},
    ProjectKey{"reflector", "wavelength_nm", Type::number, within(380, 780), "", "555", "At which a metal's reflectance is taken; of a measured BRDF of several wavelengths the nearest."},
    ProjectKey{"reflector", "slope_error_mrad", Type::number, within(0, 1000), "", "0", "Gaussian tilt of the normal, standard deviation about each of two axes."},
    ProjectKey{"reflector", "scatter", Type::tables, kAny, "", "none", "How the returned light is scattered ([scatter](../theory/scatter.md))."},
    ProjectKey{"reflector", "data_sheet", Type::table, kAny, "", "none", "What a maker states of the sheet, instead of `reflectance` and `scatter`."},
    ProjectKey{"reflector", "bsdf", Type::file, kAny, "", "none", "A measured BRDF of the surface (`.bsdf` of Zemax or LightTools), instead of `reflectance` and `scatter` ([scatter](../theory/scatter.md#measured-tables))."},
    ProjectKey{"reflector", "position_mm", Type::vector, kAny, "", "[0, 0, 0]", "Where the vertex is placed."},
    ProjectKey{"reflector", "axis", Type::axis, kAny, "", "\"+z\"", "Where the mirror opens to."},
    ProjectKey{"reflector", "turn_deg", Type::number, kAny, "", "0", "Rotation about that axis."},

    ProjectKey{"reflector.scatter", "model", Type::word, kAny, "lambert gaussian abg", "required", "Shape of the lobe."},
    ProjectKey{"reflector.scatter", "share", Type::number, up_to(1), "", "required but for abg", "Of the returned light."},
    ProjectKey{"reflector.scatter", "sigma", Type::number, within(1e-6, 1), "", "required for gaussian", "Standard deviation of each direction cosine along the surface; near the normal, that of the angle in rad."},
    ProjectKey{"reflector.scatter", "a", Type::number, kAboveZero, "", "required for abg", "BRDF over reflectance, 1/sr: a / (b + offset^g)."},
    ProjectKey{"reflector.scatter", "b", Type::number, within(1e-12, 1e6), "", "required for abg", "See `a`."},
    ProjectKey{"reflector.scatter", "g", Type::number, within(0.1, 10), "", "required for abg", "See `a`."},

    ProjectKey{"reflector.data_sheet", "total", Type::number, up_to(1), "", "required", "Total reflectance (DIN 5036-3)."},
    ProjectKey{"reflector.data_sheet", "diffuse", Type::number, within(0, 1), "", "required", "Diffuse reflectance, of the incident light; taken as Lambert's law."},
    ProjectKey{"reflector.data_sheet", "gloss_60", Type::number, kNotNegative, "", "none: the rest is mirrored", "Gloss at 60 degrees (ISO 2813, ISO 7668), from which a Gaussian lobe gets its width."},

    ProjectKey{"body", "role", Type::word, kAny, "absorber mirror lamp glass solid", "\"absorber\"", "What light hits there. A lamp's body stops only light that comes back: rays of its file have left it already. A glass is a flat plate; a solid is any closed body of a clear medium."},
    ProjectKey{"body", "file", Type::file, kAny, "", "required but for glass and `outline_mm`", "A mesh (.stl .obj)."},
    ProjectKey{"body", "outline_mm", Type::pairs, kAny, "", "none", "Of a solid of revolution, instead of `file`: corners [radius, height] of a closed outline that turns about the z axis."},
    ProjectKey{"body", "face", Type::table, kAny, "", "none", "Of a solid with `outline_mm`: its top, a free form. The outline is then open: from the axis to the upper end of a wall of one radius, which goes on to the face's rim."},
    ProjectKey{"body", "bottom_face", Type::table, kAny, "", "none", "Of a solid with `face` or `array`: its bottom about the axis, a free form too. The outline then begins in a wall of one radius that runs downward from the face's rim."},
    ProjectKey{"body", "array", Type::table, kAny, "", "none", "Of a solid with such an outline, instead of `face`: lenslets on a grid ([lens arrays](../theory/solids.md#lens-arrays))."},
    ProjectKey{"body", "smooth_below_deg", Type::number, within(0, 180), "", "20", "Of a solid: across triangles that meet at less than this angle the normal changes steadily, and an outline is a curve through corners that turn by less; 0 for facets and straight sides."},
    ProjectKey{"body", "scale", Type::number, kAboveZero, "", "1", "Millimetres of one unit of the mesh."},
    ProjectKey{"body", "open", Type::flag, kAny, "", "false", "Takes a mesh with open edges, as a sheet."},
    ProjectKey{"body", "name", Type::text, kAny, "", "the file's name, `glass` or `solid`", "Its name in the energy balance."},
    ProjectKey{"body", "reflectance", Type::number_or_pairs, kAny, "", "1", "Of a mirror, as a reflector's."},
    ProjectKey{"body", "metal", Type::word, kAny, "aluminium silver", "none", "Of a mirror, as a reflector's."},
    ProjectKey{"body", "wavelength_nm", Type::number, within(300, 4600), "", "555", "At which the index of a metal, a glass or a solid is taken; of a measured BRDF as a reflector's."},
    ProjectKey{"body", "slope_error_mrad", Type::number, within(0, 1000), "", "0", "Of a mirror, as a reflector's."},
    ProjectKey{"body", "scatter", Type::tables, kAny, "", "none", "Of a mirror, as a reflector's; of a solid, how its surface scatters what it reflects and what it lets through ([scatter](../theory/scatter.md#lenses-and-diffusers))."},
    ProjectKey{"body", "scatter_sides", Type::number_or_numbers, whole(0, 10000), "", "all", "Of a solid with `outline_mm`: numbers, from 0, of the sides that scatter, each with all of its face; side 0 leads from the first corner to the second, and `face` has the number of the last corner."},
    ProjectKey{"body", "data_sheet", Type::table, kAny, "", "none", "Of a mirror, as a reflector's."},
    ProjectKey{"body", "bsdf", Type::file, kAny, "", "none", "Of a mirror, as a reflector's."},
    ProjectKey{"body", "aperture", Type::word, kAny, "circle rectangle", "\"circle\"", "Outline of a glass."},
    ProjectKey{"body", "diameter_mm", Type::number, kAboveZero, "", "required for a circle", "Diameter of a circular glass."},
    ProjectKey{"body", "size_mm", Type::numbers, kAboveZero, "", "required for a rectangle", "Sides [x, y] of a rectangular glass."},
    ProjectKey{"body", "hole_diameter_mm", Type::number, kNotNegative, "", "0", "A glass has no hole: 0 is the only value that is taken."},
    ProjectKey{"body", "thickness_mm", Type::number, kAboveZero, "", "3", "Of a glass; it fills z = 0 to this height of its own frame."},
    ProjectKey{"body", "refractive_index", Type::number, within(1, 4), "", "1.52; 1.49 for a solid", "Of a glass or a solid."},
    ProjectKey{"body", "material", Type::word, kAny, "bk7 fused-silica pmma polycarbonate silicone soda-lime", "none", "Of a glass or a solid, instead of `refractive_index`: that of the material ([materials](../theory/materials.md))."},
    ProjectKey{"body", "catalogue", Type::file, kAny, "", "none", "Of a glass or a solid, instead of `refractive_index`: a maker's catalogue of glasses (.agf), which has `glass`."},
    ProjectKey{"body", "glass", Type::text, kAny, "", "required for a catalogue", "A name of the catalogue: \"N-BK7\"."},
    ProjectKey{"body", "dispersion", Type::flag, kAny, "", "false", "Of a solid with `material` or `catalogue`: each ray meets the index of its own wavelength, which its source must know ([materials](../theory/materials.md#dispersion))."},
    ProjectKey{"body", "absorption_per_mm", Type::number, kNotNegative, "", "0; by a catalogue's internal transmittance", "Natural absorption coefficient of a glass or a solid."},
    ProjectKey{"body", "position_mm", Type::vector, kAny, "", "[0, 0, 0]", "Where the body's origin is placed."},
    ProjectKey{"body", "axis", Type::axis, kAny, "", "\"+z\"", "Where the body's +z axis points."},
    ProjectKey{"body", "turn_deg", Type::number, kAny, "", "0", "Rotation about that axis."},

    ProjectKey{"body.scatter", "model", Type::word, kAny, "lambert gaussian abg", "required", "Shape of the lobe."},
    ProjectKey{"body.scatter", "share", Type::number, up_to(1), "", "required but for abg", "Of the returned light."},
    ProjectKey{"body.scatter", "sigma", Type::number, within(1e-6, 1), "", "required for gaussian", "Standard deviation of each direction cosine along the surface; near the normal, that of the angle in rad."},
    ProjectKey{"body.scatter", "a", Type::number, kAboveZero, "", "required for abg", "BRDF over reflectance, 1/sr: a / (b + offset^g)."},
    ProjectKey{"body.scatter", "b", Type::number, within(1e-12, 1e6), "", "required for abg", "See `a`."},
    ProjectKey{"body.scatter", "g", Type::number, within(0.1, 10), "", "required for abg", "See `a`."},

    ProjectKey{"body.data_sheet", "total", Type::number, up_to(1), "", "required", "Total reflectance (DIN 5036-3)."},
    ProjectKey{"body.data_sheet", "diffuse", Type::number, within(0, 1), "", "required", "Diffuse reflectance, of the incident light; taken as Lambert's law."},
    ProjectKey{"body.data_sheet", "gloss_60", Type::number, kNotNegative, "", "none: the rest is mirrored", "Gloss at 60 degrees (ISO 2813, ISO 7668), from which a Gaussian lobe gets its width."},

    ProjectKey{"body.array", "pitch_mm", Type::number, kAboveZero, "", "required", "Distance of neighbouring lenslets."},
    ProjectKey{"body.array", "layout", Type::word, kAny, "square hexagonal", "\"square\"", "Their grid. One is on the axis, and one beside it along x."},
    ProjectKey{"body.array", "radius_mm", Type::number, kAny, "", "required", "Radius of curvature at their apexes; below 0 they are hollow."},
    ProjectKey{"body.array", "conic", Type::number, kAny, "", "0", "Conic constant: 0 is a sphere, -1 a paraboloid."},
    ProjectKey{"body.array", "apex_mm", Type::number, kAny, "", "required", "Height of their apexes."},

    ProjectKey{"body.face", "half_mm", Type::number, kAboveZero, "", "required", "The knots span [-half_mm, half_mm] along x and y; at least the wall's radius."},
    ProjectKey{"body.face", "intervals", Type::numbers, whole(1, 1000), "", "required", "Intervals between the knots along x and y."},
    ProjectKey{"body.face", "coefficients_mm", Type::numbers, kAny, "", "required", "Heights of a bicubic B-spline on equal knots: (intervals + 3) in each direction, x first."},

    ProjectKey{"body.bottom_face", "half_mm", Type::number, kAboveZero, "", "required", "The knots span [-half_mm, half_mm] along x and y; at least the inner wall's radius."},
    ProjectKey{"body.bottom_face", "intervals", Type::numbers, whole(1, 1000), "", "required", "Intervals between the knots along x and y."},
    ProjectKey{"body.bottom_face", "coefficients_mm", Type::numbers, kAny, "", "required", "Heights of a bicubic B-spline, as those of `body.face`."},

    ProjectKey{"detector", "kind", Type::word, kAny, "far-field plane luminance rays", "required", "Intensity by direction; illuminance on a plane; a luminance image; a ray file of what leaves."},
    ProjectKey{"detector", "name", Type::text, kAny, "", "its kind", "Names its files. In a design not `history`, `tolerances`, `reflector` (of a lens: `lens`), nor `target` unless it is the target's plane; `far` is the far field that a design adds where there is none."},
    ProjectKey{"detector", "c_step_deg", Type::number, kAboveZero, "", "5", "Far field: step of C. It divides 360."},
    ProjectKey{"detector", "gamma_step_deg", Type::number, kAboveZero, "", "1", "Far field: step of gamma. It divides 180."},
    ProjectKey{"detector", "bins", Type::word, kAny, "hard tent", "\"hard\"", "Far field: a ray counts for the nearest node, or for its four neighbours in proportion to nearness."},
    ProjectKey{"detector", "position_mm", Type::vector, kAny, "", "[0, 0, 0]", "Plane, luminance: centre of the rectangle."},
    ProjectKey{"detector", "normal", Type::axis, kAny, "", "\"+z\"", "Plane: the side that is lit."},
    ProjectKey{"detector", "turn_deg", Type::number, kAny, "", "0", "Plane: rotation about its normal."},
    ProjectKey{"detector", "size_mm", Type::numbers, kAboveZero, "", "plane [1000, 1000]; luminance [200, 200]", "Sides [x, y] of the rectangle."},
    ProjectKey{"detector", "cells", Type::numbers, whole(1, 16777216), "", "[100, 100]", "Cells along x and y, at most 16777216 in all."},
    ProjectKey{"detector", "from", Type::axis, kAny, "", "one of from, from_mm", "Luminance: where a distant observer is."},
    ProjectKey{"detector", "from_mm", Type::vector, kAny, "", "one of from, from_mm", "Luminance: where a near observer is."},
    ProjectKey{"detector", "up", Type::axis, kAny, "", "\"+z\"", "Luminance: what is up in the picture; where the view is along z, \"+y\"."},
    ProjectKey{"detector", "half_angle_deg", Type::number, up_to(90, true), "", "2", "Luminance, distant observer: half angle of the cone of light that counts."},
    ProjectKey{"detector", "pupil_radius_mm", Type::number, kAboveZero, "", "0.02 of the distance", "Luminance, near observer: radius of the pupil."},
    ProjectKey{"detector", "format", Type::word, kAny, "tm25 zemax-binary zemax-text lighttools-binary lighttools-ascii speos mcpl asap text", "\"tm25\"", "Rays: format of the file."},

    ProjectKey{"target", "kind", Type::word, kAny, "far-field plane", "\"far-field\"", "Intensity by direction, or illuminance on a plane."},
    ProjectKey{"target", "file", Type::file, kAny, "", "none", "IES or EULUMDAT; for a plane .csv (lx, first row at the highest y) or .png. Needed unless a zone has a minimum."},
    ProjectKey{"target", "mode", Type::word, kAny, "shape absolute", "\"shape\"", "Whether the scale of the light is free or counts too."},
    ProjectKey{"target", "white_lx", Type::number, kAboveZero, "", "required for a .png with mode absolute", "Illuminance of a picture's white."},
    ProjectKey{"target", "position_mm", Type::vector, kAny, "", "required for a plane", "Centre of the plane's rectangle."},
    ProjectKey{"target", "normal", Type::axis, kAny, "", "required for a plane", "The side that is lit: \"+z\" for a floor."},
    ProjectKey{"target", "turn_deg", Type::number, kAny, "", "0", "Rotation of the plane about its normal."},
    ProjectKey{"target", "size_mm", Type::numbers, kAboveZero, "", "required for a plane", "Sides [x, y] of the rectangle."},
    ProjectKey{"target", "axis", Type::axis, kAny, "", "required for zones of h_deg and v_deg", "The direction of h = v = 0."},
    ProjectKey{"target", "zone", Type::tables, kAny, "", "none", "Minima and maxima by zone."},

    ProjectKey{"target.zone", "name", Type::text, kAny, "", "\"zone 1\", ...", "Its name in messages, results and `mean_of`."},
    ProjectKey{"target.zone", "gamma_deg", Type::number_or_numbers, within(0, 180), "", "required, or h and v, or x and y", "A number or [low, high]."},
    ProjectKey{"target.zone", "c_deg", Type::number_or_numbers, within(-360, 720), "", "with gamma_deg", "A number or [low, high], at most 360 wide."},
    ProjectKey{"target.zone", "h_deg", Type::number_or_numbers, within(-180, 180), "", "with v_deg", "To the right, seen along the target's axis."},
    ProjectKey{"target.zone", "v_deg", Type::number_or_numbers, within(-90, 90), "", "with h_deg", "Up from the target's axis."},
    ProjectKey{"target.zone", "x_mm", Type::number_or_numbers, within(-1e9, 1e9), "", "required for a plane", "A number or [low, high] on the plane."},
    ProjectKey{"target.zone", "y_mm", Type::number_or_numbers, within(-1e9, 1e9), "", "required for a plane", "A number or [low, high] on the plane."},
    ProjectKey{"target.zone", "cell_deg", Type::number, up_to(30), "", "1", "Side of the measuring cells."},
    ProjectKey{"target.zone", "cell_mm", Type::number, kAboveZero, "", "a tenth of the shorter side, or of a line", "Side of the measuring cells on a plane; required for a point."},
    ProjectKey{"target.zone", "min_cd", Type::number, kAboveZero, "", "none", "Minimum intensity of every cell."},
    ProjectKey{"target.zone", "max_cd", Type::number, kAboveZero, "", "none", "Maximum intensity of every cell."},
    ProjectKey{"target.zone", "min_cd_per_klm", Type::number, kAboveZero, "", "none", "Minimum intensity per 1000 lm of the sources."},
    ProjectKey{"target.zone", "max_cd_per_klm", Type::number, kAboveZero, "", "none", "Maximum intensity per 1000 lm of the sources."},
    ProjectKey{"target.zone", "min_lx", Type::number, kAboveZero, "", "none", "Minimum illuminance of every cell of a plane."},
    ProjectKey{"target.zone", "max_lx", Type::number, kAboveZero, "", "none", "Maximum illuminance of every cell of a plane."},
    ProjectKey{"target.zone", "min_uo", Type::number, up_to(1, true), "", "none", "Overall uniformity: minimum over mean illuminance."},
    ProjectKey{"target.zone", "min_ul", Type::number, up_to(1, true), "", "none", "Uniformity along a line: minimum over maximum illuminance."},
    ProjectKey{"target.zone", "min_of_mean", Type::number, kAboveZero, "", "none", "Minimum of every cell as a multiple of the mean over a zone."},
    ProjectKey{"target.zone", "max_of_mean", Type::number, kAboveZero, "", "none", "Maximum of every cell as a multiple of the mean over a zone."},
    ProjectKey{"target.zone", "mean_of", Type::text, kAny, "", "required with min_of_mean, max_of_mean", "Name of the zone that their mean is of; `min_uo` is of the mean of its own zone."},

    ProjectKey{"design", "reflector", Type::number, kAny, "", "0 where there is one", "Number, from 0, of the reflector that is shaped: of family revolution with a round rim, trough or bspline."},
    ProjectKey{"design", "free_sides", Type::number_or_numbers, whole(0, 10000), "", "none", "Of a lens, instead of a reflector: numbers, from 0, of the sides of its `outline_mm` that are shaped, each with all of its face; side 0 leads from the first corner to the second. Beside a bspline the face from the axis to the base may be free as well; `entry` says what it becomes."},
    ProjectKey{"design", "entry", Type::word, kAny, "cavity bspline", "\"cavity\"", "Of a lens of family bspline with a free face from the axis to the base: a cavity is chosen for it, or it becomes a free form too."},
    ProjectKey{"design", "optimizer", Type::word, kAny, "auto least-squares tree annealing cma-es direct", "\"auto\"", "How the shape is searched for."},
    ProjectKey{"design", "time_s", Type::number, kAboveZero, "", "60", "Time for search, validation and trace together. It ends the search; no choice within depends on it."},
    ProjectKey{"design", "family", Type::word, kAny, "revolution bspline", "\"revolution\"", "Of a lens: what its free face becomes. A bspline is a free form; the face leads from the upper end of a wall, parallel to the axis, to the axis."},
    ProjectKey{"design", "intervals", Type::number_or_numbers, whole(1, 60), "", "chosen by the search", "Fixes the intervals between knots: one number, or two along x and y."},
    ProjectKey{"design", "restarts", Type::number, whole(0, 1000), "", "while there is time", "Restarts in a row without gain that end the search."},
    ProjectKey{"design", "light_weight", Type::number, within(0, 100), "", "0.1", "Weight of light that misses the target's rectangle: 0.1 counts a tenth of it as an error of 3.2 %. With `mode = \"shape\"`; of lenses, and of mirrors that are not of revolution with `optimizer = \"auto\"`."},
    ProjectKey{"design", "limits", Type::table, kAny, "", "none", "What the mirror or lens must not be. Of a lens: `max_diameter_mm`, `max_height_mm`, `min_thickness_mm`, `min_draft_deg` and `symmetry`."},
    ProjectKey{"design", "tolerances", Type::table, kAny, "", "none", "What a manufactured luminaire may differ by."},

    ProjectKey{"design.limits", "max_diameter_mm", Type::number, kAboveZero, "", "none", "Diameter of the aperture, or of a lens."},
    ProjectKey{"design.limits", "min_thickness_mm", Type::number, kAboveZero, "", "none", "Of a lens: distance through it between faces that do not meet, and along the axis."},
    ProjectKey{"design.limits", "min_draft_deg", Type::number, up_to(90, true), "", "none", "Of a lens: angle between its free faces and the axis, along which the mould opens."},
    ProjectKey{"design.limits", "min_opening_mm", Type::number, kAboveZero, "", "none", "Shorter side of the aperture."},
    ProjectKey{"design.limits", "min_hole_diameter_mm", Type::number, kAboveZero, "", "none", "Diameter of the hole."},
    ProjectKey{"design.limits", "max_height_mm", Type::number, kAboveZero, "", "none", "Largest minus smallest height of the mirror or lens along its axis."},
    ProjectKey{"design.limits", "max_slope_deg", Type::number, up_to(90, true), "", "none", "Angle between the normal and the axis of the mirror: draft for the tool."},
    ProjectKey{"design.limits", "min_radius_mm", Type::number, kAboveZero, "", "none", "Radius of curvature anywhere, concave or convex: the radius of the tool."},
    ProjectKey{"design.limits", "min_efficiency", Type::number, up_to(1), "", "none", "Share of the sources' flux that leaves the luminaire."},
    ProjectKey{"design.limits", "symmetry", Type::word, kAny, "none c0-c180 c90-c270 both rotational", "\"none\"", "Planes that the mirror, or a lens's free forms, are symmetric about."},
    ProjectKey{"design.limits", "body_clearance_mm", Type::number, kNotNegative, "", "bodies are ignored", "Distance that the mirror keeps from every body."},
    ProjectKey{"design.limits", "keep_out", Type::tables, kAny, "", "none", "Volumes that the mirror keeps out of."},
    ProjectKey{"design.limits", "glare", Type::table, kAny, "", "none", "A maximum of intensity beyond an angle."},

    ProjectKey{"design.limits.keep_out", "kind", Type::word, kAny, "box cylinder mesh", "required", "Form of the volume, in the luminaire frame."},
    ProjectKey{"design.limits.keep_out", "file", Type::file, kAny, "", "required for mesh", "A mesh (.stl .obj)."},
    ProjectKey{"design.limits.keep_out", "min_mm", Type::vector, kAny, "", "required for box", "Corner with the smallest coordinates."},
    ProjectKey{"design.limits.keep_out", "max_mm", Type::vector, kAny, "", "required for box", "Corner with the largest coordinates."},
    ProjectKey{"design.limits.keep_out", "from_mm", Type::vector, kAny, "", "required for cylinder", "Centre of one end."},
    ProjectKey{"design.limits.keep_out", "to_mm", Type::vector, kAny, "", "required for cylinder", "Centre of the other end."},
    ProjectKey{"design.limits.keep_out", "radius_mm", Type::number, kAboveZero, "", "required for cylinder", "Radius."},
    ProjectKey{"design.limits.keep_out", "clearance_mm", Type::number, kNotNegative, "", "0", "Distance that the mirror keeps from it."},

    ProjectKey{"design.limits.glare", "beyond_deg", Type::number, up_to(170), "", "required", "Angle from the mirror's axis."},
    ProjectKey{"design.limits.glare", "max_cd", Type::number, kAboveZero, "", "one of max_cd, max_cd_per_klm", "Intensity there."},
    ProjectKey{"design.limits.glare", "max_cd_per_klm", Type::number, kAboveZero, "", "one of max_cd, max_cd_per_klm", "Intensity there per 1000 lm of the sources."},

    ProjectKey{"design.tolerances", "source_shift_mm", Type::number, kNotNegative, "", "0.1", "Shift of the sources along x, y and z, either way."},
    ProjectKey{"design.tolerances", "source_tilt_deg", Type::number, kNotNegative, "", "1", "Tilt of the sources about x and y, either way."},
    ProjectKey{"design.tolerances", "slope_error_mrad", Type::number, kNotNegative, "", "1", "Slope error of the mirror, added to its own as squares."},
    ProjectKey{"design.tolerances", "reflectance", Type::number, kShare, "", "0.02", "Change of the reflectance, either way."},
    ProjectKey{"design.tolerances", "samples", Type::number, whole(2, 1000), "", "16", "Cases in which everything changes at once."},
    ProjectKey{"design.tolerances", "rays", Type::number, whole(10000, 1000000000), "", "262144", "Rays of each case."},
};
// clang-format on

}  // namespace

bool KeyRange::contains(double x) const {
  const bool low = min_excluded ? x > min : x >= min, high = max_excluded ? x < max : x <= max;
  return low && high && (!whole || x == std::floor(x));
}

std::string KeyRange::text() const {
  if (whole) return fmt::format("a whole number from {} to {}", min, max);
  const bool has_min = std::isfinite(min), has_max = std::isfinite(max);
  if (has_min && has_max && !min_excluded && !max_excluded) return fmt::format("{} to {}", min, max);
  const std::string low = has_min ? fmt::format("{} {}", min_excluded ? ">" : ">=", min) : "";
  const std::string high = has_max ? fmt::format("{} {}", max_excluded ? "<" : "<=", max) : "";
  return low + (has_min && has_max ? " and " : "") + high;
}

std::span<const ProjectKey> project_keys() { return kKeys; }

const ProjectKey* find_key(std::span<const ProjectKey> keys, std::string_view table, std::string_view key) {
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const ProjectKey& k) { return k.table == table && k.key == key; });
  return found == keys.end() ? nullptr : &*found;
}

std::string_view unit_of(std::string_view key) {
  using Ending = std::pair<std::string_view, std::string_view>;
  static constexpr std::array<Ending, 10> kEndings{{{"absorption_per_mm", "1/mm"},
                                                    {"_per_klm", "cd/klm"},
                                                    {"_mm", "mm"},
                                                    {"_deg", "degrees"},
                                                    {"_mrad", "mrad"},
                                                    {"_lm", "lm"},
                                                    {"_w", "W"},
                                                    {"_cd", "cd"},
                                                    {"_lx", "lx"},
                                                    {"_s", "s"}}};
  for (const auto& [ending, unit] : kEndings) {
    if (key.ends_with(ending)) return unit;
  }
  return "";
}

std::string alternatives(std::string_view words) {
  std::string text;
  for (std::size_t begin = 0; begin < words.size();) {
    const std::size_t end = std::min(words.find(' ', begin), words.size());
    const bool last = end == words.size();
    if (!text.empty()) text += last ? " or " : ", ";
    text += words.substr(begin, end - begin);
    begin = end + 1;
  }
  return text;
}

}  // namespace lucerna
