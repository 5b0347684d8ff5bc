// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project.h"

namespace lucerna {
namespace {

constexpr const char* kTemplate =
    R"(# A Lucerna project: which light falls on which mirror, and what is looked at.
# lucerna trace PROJECT.toml -o DIR, or lucerna design PROJECT.toml -o DIR
# Lengths in mm, angles in degrees, fluxes in lm (or W). Luminaire frame: z up, nadir (gamma 0) = -z, C0 = +x, C90 = +y.
# File names are relative to this file. Take away the # of a block to use it.

# ---- sources: any number; their fluxes add ----
[[source]]
kind = "led"                  # point disk rectangle cylinder sphere filament led phong500 phong25 radial cosine
flux_lm = 1000.0              # flux_w for radiometric sources
position_mm = [0, 0, 0]       # where the source's origin goes
axis = "+z"                   # where its +z points: +x -x +y -y +z -z or a vector
turn_deg = 0.0                # then about that axis

# A ray file or a model (lucerna compress); its own flux counts unless flux_lm or flux_w overrides it. Solids with
# dispersion need wavelengths: the file's, or wavelength_nm = 450, or spectrum = "white.csv" (lines of nm, power).
#[[source]]
#file = "led.tm25ray"
#flux_lm = 337.0
#position_mm = [5, 0, 0]

# An analytic emitter with its sizes, and the surface that its rays are given on (none, sphere, cylinder, box, plane).
#[[source]]
#kind = "cylinder"
#radius_mm = 1.0
#length_mm = 6.0
#surface = "sphere"
#surface_mm = 10.0
#axis = "+x"

# ---- mirrors: each in its own frame, vertex at the origin, opening along +z, then placed; the side to +z reflects ----
[[reflector]]
family = "revolution"         # revolution, trough, faceted, bspline, heightmap, mesh
preset = "parabola"           # parabola, ellipse, hyperbola (these two have focal2_mm as well)
focal_mm = 15.0               # from the vertex
aperture = "circle"           # circle: diameter_mm; rectangle: size_mm = [x, y]
diameter_mm = 100.0
hole_diameter_mm = 0.0        # for the lamp
position_mm = [0, 0, 15]      # here: the focus is at the source
axis = "-z"                   # the mirror opens downward
turn_deg = 0.0
reflectance = 0.92
slope_error_mrad = 0.0        # Gaussian tilt of the normal, standard deviation about each of two axes
# Instead of reflectance: data_sheet = { total = 0.87, diffuse = 0.12, gloss_60 = 450 }, or bsdf = "sheet.bsdf".

# A profile as points [r, z] from the vertex to the rim, a spline through them; reflectance over the angle of incidence.
#[[reflector]]
#family = "revolution"
#profile_mm = [[0, 0], [20, 6], [40, 24]]
#position_mm = [200, 0, 15]
#axis = "-z"
#reflectance = [[0, 0.92], [60, 0.90], [85, 0.95]]   # or metal = "aluminium", wavelength_nm = 555
#scatter = [{ model = "lambert", share = 0.05 }, { model = "gaussian", share = 0.3, sigma = 0.02 }]   # of what it returns

# A profile that is no function of r, vertex first: deep concentrators, mirrors that close in again. Or file = "profile.csv"
# with lines r,z.
#[[reflector]]
#family = "revolution"
#profile_mm = [[0, 0], [18, 12], [20, 30], [14, 44]]
#position_mm = [250, 0, 10]
#axis = "-z"

# An ellipsoid past its equator (36 mm wide here), from the hole about its vertex to the mouth.
#[[reflector]]
#family = "revolution"
#preset = "ellipse"
#focal_mm = 5.0
#focal2_mm = 65.0
#mouth_diameter_mm = 30.0
#hole_diameter_mm = 4.0
#position_mm = [-100, 0, 5]
#axis = "-z"

# An ellipse drawn along y.
#[[reflector]]
#family = "trough"
#preset = "ellipse"
#focal_mm = 10.0
#focal2_mm = 80.0
#aperture = "rectangle"
#size_mm = [40, 100]
#position_mm = [300, 0, 10]
#axis = "-z"

# Facets on a base of revolution: flat, or pillows of a radius of curvature.
#[[reflector]]
#family = "faceted"
#preset = "parabola"
#focal_mm = 15.0
#diameter_mm = 80.0
#pitch_mm = 8.0
#pillow_radius_mm = 60.0
#position_mm = [400, 0, 15]
#axis = "-z"

# Free form: a bicubic B-spline of heights over a paraboloid; (intervals + 3) coefficients a side, x first.
#[[reflector]]
#family = "bspline"
#focal_mm = 15.0
#intervals = [8, 8]
#aperture = "rectangle"
#size_mm = [80, 60]
#position_mm = [500, 0, 15]
#axis = "-z"

# Sampled heights (.csv .txt .npy .pgm .png), the first row at +y; z = z_offset_mm + z_scale_mm * number or level of grey.
#[[reflector]]
#family = "heightmap"
#file = "heights.csv"
#size_mm = [80, 60]
#z_scale_mm = 1.0
#z_offset_mm = 0.0
#first_row = "top"
#position_mm = [600, 0, 15]
#axis = "-z"

# A mesh as a mirror on both sides; smooth_normals bends light as the curved surface does, up to creases of that angle.
#[[reflector]]
#family = "mesh"
#file = "mirror.stl"
#scale = 1.0
#smooth_normals = true
#crease_deg = 30.0
#slope_error_mrad = 0.0
#reflectance = 0.9
#position_mm = [700, 0, 0]

# ---- bodies: .stl or .obj, closed unless open = true ----
#[[body]]
#file = "housing.stl"
#name = "housing"
#role = "absorber"
#position_mm = [0, 0, 60]

# A sheet that reflects on both sides.
#[[body]]
#file = "sheet.stl"
#role = "mirror"
#reflectance = 0.85
#open = true
#position_mm = [0, 0, 90]

# The lamp's own body: rays of its file have left it already, so it stops only light that comes back.
#[[body]]
#file = "bulb.stl"
#role = "lamp"

# A flat cover glass: fills z = 0 .. thickness_mm of its own frame; Fresnel's losses and absorption.
#[[body]]
#role = "glass"
#diameter_mm = 110.0
#thickness_mm = 3.0
#refractive_index = 1.52       # or material = "pmma", wavelength_nm = 555
#absorption_per_mm = 0.002
#position_mm = [0, 0, -20]

# A closed body of a clear medium: a lens, a TIR collimator. A mesh (file = "lens.stl"), or an outline
# [radius, height] that turns about the z axis: a smooth curve through corners that turn by less than
# smooth_below_deg (20).
#[[body]]
#role = "solid"
#outline_mm = [[0, 0], [20, 0], [20, 2], [0, 6]]
#refractive_index = 1.49       # or material = "pmma", wavelength_nm = 555, or each ray's own: dispersion = true
#absorption_per_mm = 0.0005
#scatter_sides = 2             # a frosted face
#scatter = [{ model = "gaussian", share = 1.0, sigma = 0.2 }]
#position_mm = [0, 0, -40]

# A lens array: lenslets on a square or hexagonal grid, as the top of a plate with a wall. Without [body.array]
# and with [body.face] the top is a B-spline.
#[[body]]
#role = "solid"
#outline_mm = [[0, 0], [20, 0], [20, 1]]
#position_mm = [0, 0, -80]
#[body.array]
#pitch_mm = 2.0
#layout = "hexagonal"
#radius_mm = 3.0               # of curvature; below 0 they are hollow
#conic = -1.0
#apex_mm = 2.0

# ---- detectors: any number at once; the name names the files ----
[[detector]]
name = "far"
kind = "far-field"            # intensity by direction: .ldt .ies .csv .svg
c_step_deg = 5.0
gamma_step_deg = 1.0
bins = "hard"                 # tent: a ray counts for its four neighbours; smoother from few rays

# Illuminance on a plane, on the side that normal points to: .csv .png
#[[detector]]
#kind = "plane"
#name = "floor"
#position_mm = [0, 0, -2500]
#normal = "+z"
#turn_deg = 0.0
#size_mm = [4000, 4000]
#cells = [100, 100]

# Luminance as seen from far away, by light within half_angle_deg of the direction from; up is up in the picture.
#[[detector]]
#kind = "luminance"
#name = "side"
#from = [1, 0, -1]
#up = "+z"
#half_angle_deg = 2.0
#position_mm = [0, 0, 0]
#size_mm = [200, 200]
#cells = [100, 100]

# Luminance as seen from a point, by light through a pupil there.
#[[detector]]
#kind = "luminance"
#name = "eye"
#from_mm = [500, 0, -1500]
#pupil_radius_mm = 20.0
#position_mm = [0, 0, 0]
#size_mm = [200, 200]
#cells = [100, 100]

# All rays that leave, as a new source: tm25 zemax-binary zemax-text lighttools-binary lighttools-ascii speos mcpl asap text
#[[detector]]
#kind = "rays"
#name = "luminaire"
#format = "tm25"

# ---- what a design is to reach (lucerna design), and what it may not do; it shapes the reflector (of several: reflector = 0, 1, ...) ----
#[target]
#file = "wanted.ldt"
#mode = "shape"
#[design]
#optimizer = "auto"
#time_s = 60
#light_weight = 0.1             # of light beside the target: 0.1 counts a tenth of it as an error of 3.2 %
#[design.limits]
#max_diameter_mm = 120.0
#max_height_mm = 60.0
#symmetry = "none"
#min_efficiency = 0.6
#[design.tolerances]
#source_shift_mm = 0.2

# Or: the illuminance on a plane, as a .csv (lx, its first row at the highest y) or a .png (white_lx: the illuminance of its white).
#[target]
#kind = "plane"
#file = "wanted.png"
#position_mm = [0, 0, -2500]
#normal = "+z"
#size_mm = [3000, 2000]
#white_lx = 500.0
#mode = "absolute"

# Instead of a reflector, faces of the one solid with outline_mm: free_sides = 2 in [design] (side 0 leads from the
# first corner to the second; with family = "bspline" also [0, 2], for light that is to be wide), with max_height_mm,
# max_diameter_mm, min_thickness_mm, min_draft_deg as limits.

# Beside a file or without one a free form may have bounds by zone, as standards have them:
#   [[target.zone]] name, gamma_deg and c_deg (or h_deg and v_deg about the target's axis; x_mm and y_mm on a plane),
#   each a number or [low, high], and min_cd, max_cd, min_lx, max_lx, min_uo, min_ul: docs/theory/zones.md
)";

}  // namespace

std::string project_template() { return kTemplate; }

}  // namespace lucerna
