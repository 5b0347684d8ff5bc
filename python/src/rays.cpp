// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <map>

#include "call.h"
#include "lucerna/ray_file.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/source.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kRaySetClassDoc =
    R"(Rays in memory: starts, directions, weights, and what their file says.

Arrays are read-only views of the set's own memory and keep it alive. A set never changes, so threads may
share it. It pickles without loss.)";

constexpr const char* kFromArraysDoc =
    R"(from_arrays(position_mm, direction, *, weight=None, flux_lm=None, flux_w=None, wavelength_nm=None)
--

A set of given rays; the arrays are copied.

Parameters
----------
position_mm : array_like (n, 3)
    Starts, mm.
direction : array_like (n, 3)
    Directions of any length above 0.
weight : array_like (n,), optional
    Relative flux of each ray, >= 0; equal where it is not given.
flux_lm, flux_w : float, optional
    Total flux, lm or W; one of them at most.
wavelength_nm : array_like (n,), optional
    Wavelength of each ray, nm.

Raises
------
InputError
    For wrong shapes, numbers that are not finite, negative weights, a direction of length 0.)";

constexpr const char* kStatisticsDoc = R"(statistics()
--

Count, extent, means and virtual focus.

Returns
-------
Record
    rays, weight_sum, weight_min, weight_max, extent_min_mm, extent_max_mm, mean_start_mm, mean_direction,
    virtual_focus_mm (None for parallel rays), backwards_share, equal_weights, effective_rays. What needs flux
    is None without.)";

constexpr const char* kSaveDoc = R"(save(path, *, format=None, length_unit='mm')
--

Writes the rays as a file, whole or not at all.

Parameters
----------
path : path_like
    Its ending says the format where it means only one: .tm25ray, .sdf, .dis, .mcpl.
format : str, optional
    'tm25', 'zemax-binary', 'zemax-text', 'lighttools-binary', 'lighttools-ascii', 'speos', 'mcpl', 'asap'
    or 'text'.
length_unit : str
    Unit of the file's lengths, for formats that have a choice: 'mm', 'cm', 'm', 'inch' or 'feet'.

Returns
-------
list of str
    What the format cannot hold.)";

constexpr const char* kReadRaysDoc =
    R"(read_rays(path, *, salvage=False, format=None, text_columns=[], callback=None)
--

Reads a ray file: TM-25, Zemax, LightTools, SPEOS, MCPL, ASAP or text, found from its content.

Parameters
----------
path : path_like
salvage : bool
    Takes what is whole of a damaged file.
format : str, optional
    Reads the file as this format.
text_columns : list of str
    For format 'text': what each column holds, as 'x_mm', 'kx', 'flux_lm', 'wavelength_nm', '-'.
callback : callable, optional
    Gets a Record with phase, done and total (rays), ten times a second at most.

Returns
-------
RaySet

Raises
------
FileNotFoundError, OSError
    Where the file cannot be read.
InputError
    Where it is no ray file, or damaged; place is the byte, line or ray.)";

constexpr const char* kMakeSourceDoc =
    R"(make_source(kind, rays, *, seed=1, sequence='random', flux_lm=None, flux_w=None, radius_mm=None,
    length_mm=None, size_mm=None, ghost_share=None, surface=None, surface_mm=[])
--

Rays of an exactly known source.

Parameters
----------
kind : str
    'point', 'disk', 'rectangle', 'cylinder', 'sphere', 'filament', 'led', 'phong500', 'phong25', 'radial' or
    'cosine'.
rays : int
    How many; 1e6 is taken, too.
seed : int
    Of the random numbers.
sequence : str
    'random' (independent) or 'sobol' (evenly spread).
flux_lm, flux_w : float, optional
    Total flux, lm or W; 1000 lm where neither is given.
radius_mm, length_mm : float, optional
    Sizes of a disk, cylinder, sphere or filament, mm; the radius of a synthetic set's sphere.
size_mm : sequence of 2 floats, optional
    Sides of a rectangle, mm; 1 and 1 where they are not given.
ghost_share : float, optional
    Share of a filament's flux in its image in the bulb; 0.05 where it is not given.
surface : str, optional
    Where rays start: 'none', 'plane', 'sphere', 'cylinder' or 'box'.
surface_mm : sequence of float
    Sizes of that surface, mm.

Returns
-------
RaySet)";

}  // namespace

FluxUnit flux_unit(const std::string& symbol) {
  if (symbol == "lm") return FluxUnit::lumen;
  if (symbol == "W") return FluxUnit::watt;
  throw InputError("unit: found '" + symbol + "', expected 'lm' or 'W'");
}

std::optional<GivenFlux> given_flux(std::optional<double> flux_lm, std::optional<double> flux_w) {
  if (flux_lm && flux_w) throw InputError("flux_lm and flux_w exclude each other", ErrorCause::contradiction);
  if (!flux_lm && !flux_w) return std::nullopt;
  const GivenFlux given{flux_lm ? *flux_lm : *flux_w, flux_lm ? FluxUnit::lumen : FluxUnit::watt};
  if (!(given.flux > 0.0 && std::isfinite(given.flux)))
    throw InputError("flux: found " + std::to_string(given.flux) + ", expected a finite number above 0",
                     ErrorCause::out_of_range);
  return given;
}

std::uint64_t ray_count(double rays) {
  // 2^40 rays are more than any memory or trace takes.
  if (!(rays >= 0.0 && rays <= 0x1p40 && rays == std::floor(rays)))
    throw InputError("rays: found " + std::to_string(rays) + ", expected a whole number from 0 to 2^40",
                     ErrorCause::out_of_range);
  return static_cast<std::uint64_t>(rays);
}

namespace {

const RayBlock& block(const Rays& rays) { return rays.set->rays; }

/// Three columns as an array of shape (n, 3).
py::array_t<float> copied(const std::vector<float>& x, const std::vector<float>& y,
                          const std::vector<float>& z) {
  std::vector<float> out(3 * x.size());
  {
    const py::gil_scoped_release unlocked;
    for (std::size_t i = 0; i < x.size(); ++i) {
      out[3 * i] = x[i];
      out[3 * i + 1] = y[i];
      out[3 * i + 2] = z[i];
    }
  }
  const Shape shape = grid(x.size(), 3);
  return owned(std::move(out), shape);
}

/// The same as a view where the columns lie equally far apart, as what is allocated one after another usually
/// does; else a copy.
py::array_t<float> stacked(const py::object& self, std::vector<float> RayBlock::*x_of,
                           std::vector<float> RayBlock::*y_of, std::vector<float> RayBlock::*z_of) {
  const RayBlock& b = block(self.cast<const Rays&>());
  const std::vector<float>&x = b.*x_of, &y = b.*y_of, &z = b.*z_of;
  if (auto seen = stacked_view(x, y, z, self)) return *std::move(seen);
  return copied(x, y, z);
}

/// Calls `put` with i and the three numbers of vector i of an (n, 3) array, in whatever precision they are,
/// without a second copy of float32 data.
template <class Put>
void take_vectors(const py::handle& given, std::string_view name, std::size_t n, const Put& put) {
  const auto check = [&](const py::array& array) {
    if (array.ndim() != 2 || vector_count(array) != n)
      throw InputError(std::string(name) + ": found shape " + shape_text(array) + ", expected (" +
                       std::to_string(n) + ", 3)");
  };
  const auto each = [&](const auto& array) {
    check(array);
    const auto* v = array.data();
    for (std::size_t i = 0; i < n; ++i) put(i, v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  };
  if (py::isinstance<py::array_t<float>>(given)) {
    each(input_vectors<float>(given, name));
  } else {
    each(input_vectors<double>(given, name));
  }
}

[[noreturn]] void refuse_vector(std::string_view name, std::size_t i, const std::string& found,
                                const std::string& expected) {
  throw InputError(std::string(name) + ": found " + found + " at index " + std::to_string(i) + ", expected " +
                   expected);
}

void take_positions(const py::object& given, RayBlock& b) {
  take_vectors(given, "position_mm", b.size(), [&](std::size_t i, auto x, auto y, auto z) {
    b.x_mm[i] = static_cast<float>(x), b.y_mm[i] = static_cast<float>(y), b.z_mm[i] = static_cast<float>(z);
    if (!std::isfinite(b.x_mm[i]) || !std::isfinite(b.y_mm[i]) || !std::isfinite(b.z_mm[i]))
      refuse_vector("position_mm", i, "a number that float32 cannot hold", "mm below 3.4e38");
  });
}

/// Directions of any length to unit length; those whose square is 1 to 1e-6 in float32 keep their bits, by
/// the rule of readers of files: what this leaves alone, they leave alone.
void take_directions(const py::object& given, RayBlock& b) {
  take_vectors(given, "direction", b.size(), [&](std::size_t i, auto x, auto y, auto z) {
    b.kx[i] = static_cast<float>(x), b.ky[i] = static_cast<float>(y), b.kz[i] = static_cast<float>(z);
    const Vec3 single{b.kx[i], b.ky[i], b.kz[i]};
    if (std::abs(dot(single, single) - 1.0) <= 1e-6) return;
    // Over the largest component first: squares of 1e-200 and 1e200 are no numbers.
    const auto dx = static_cast<double>(x), dy = static_cast<double>(y), dz = static_cast<double>(z);
    const double most = std::max({std::abs(dx), std::abs(dy), std::abs(dz)});
    if (!(most > 0.0)) refuse_vector("direction", i, "a vector of length 0", "directions");
    const Vec3 k{dx / most, dy / most, dz / most};
    const double size = std::sqrt(dot(k, k));
    b.kx[i] = static_cast<float>(k.x / size);
    b.ky[i] = static_cast<float>(k.y / size);
    b.kz[i] = static_cast<float>(k.z / size);
  });
}

void take_weights(const py::object& weight, RayBlock& b) {
  if (weight.is_none()) {
    std::fill(b.weight.begin(), b.weight.end(), 1.0F);
    return;
  }
  const auto given = input_row<float>(weight, "weight");
  if (given.size() != b.size())
    throw InputError("weight: found " + std::to_string(given.size()) + " numbers, expected " +
                     std::to_string(b.size()));
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (given[i] < 0.0F)
      throw InputError("weight: found " + std::to_string(given[i]) + " at index " + std::to_string(i) +
                       ", expected >= 0");
  }
  b.weight = given;
}

Rays from_arrays(const py::object& position_mm, const py::object& direction, const py::object& weight,
                 std::optional<double> flux_lm, std::optional<double> flux_w,
                 const py::object& wavelength_nm) {
  const std::optional<GivenFlux> flux = given_flux(flux_lm, flux_w);
  auto set = std::make_shared<RaySet>();
  if (flux) {
    set->header.flux_unit = flux->unit;
    set->header.set_flux(flux->flux);
  }
  const py::array first = as_array(position_mm, "position_mm");
  RayBlock& b = set->rays;
  b.resize(first.ndim() == 2 ? static_cast<std::size_t>(first.shape(0)) : 0, 0);
  take_positions(position_mm, b);
  take_directions(direction, b);
  take_weights(weight, b);
  if (!wavelength_nm.is_none()) {
    auto nm = input_row<float>(wavelength_nm, "wavelength_nm");
    if (nm.size() != b.size())
      throw InputError("wavelength_nm: found " + std::to_string(nm.size()) + " numbers, expected " +
                       std::to_string(b.size()));
    for (const float x : nm) {
      if (!(x > 0.0f && std::isfinite(x)))
        throw InputError("wavelength_nm: found " + std::to_string(x) + ", expected numbers above 0");
    }
    set->header.columns.push_back({ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)});
    b.extra.push_back(std::move(nm));
  }
  return {set, {}};
}

py::array_t<double> flux_per_ray(const Rays& rays) {
  const std::optional<double> flux = rays.set->header.flux();
  if (!flux) throw InputError("the rays' total flux is not stated", ErrorCause::missing, "flux");
  const double sum = sum_of_weights(block(rays));
  std::vector<double> out(block(rays).size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = sum > 0.0 ? *flux * static_cast<double>(block(rays).weight[i]) / sum : 0.0;
  return owned(std::move(out));
}

py::object statistics(const Rays& rays) {
  const RaySummary s = released([&] { return summarize(block(rays)); });
  py::dict out;
  out["rays"] = s.count;
  out["weight_sum"] = s.weight_sum;
  out["weight_min"] = s.weight_min;
  out["weight_max"] = s.weight_max;
  out["extent_min_mm"] = vector(s.extent_min_mm);
  out["extent_max_mm"] = vector(s.extent_max_mm);
  out["mean_start_mm"] = vector(s.mean_start_mm);
  out["mean_direction"] = vector(s.mean_direction);
  out["virtual_focus_mm"] = s.virtual_focus && s.virtual_focus->determined
                                ? py::object(vector(s.virtual_focus->point_mm))
                                : py::none();
  out["backwards_share"] = s.backwards_share;
  out["equal_weights"] = s.equal_weights;
  out["effective_rays"] = s.effective_rays;
  return record(out);
}

/// Extra columns by their labels.
py::dict columns(const py::object& self) {
  const auto& rays = self.cast<const Rays&>();
  py::dict out;
  for (std::size_t i = 0; i < rays.set->header.columns.size(); ++i)
    out[py::str(rays.set->header.columns[i].label)] = view(block(rays).extra[i], self);
  return out;
}

py::list spectra(const Rays& rays) {
  py::list out;
  for (const SpectralTable& s : rays.set->header.spectra)
    out.append(py::make_tuple(owned(std::vector<float>(s.wavelength_nm)),
                              owned(std::vector<float>(s.relative_power))));
  return out;
}

/// Every text of a header with its name.
template <class Texts, class Visit>
void visit_texts(Texts& t, const Visit& visit) {
  visit("light_source", t.light_source);
  visit("manufacturer", t.manufacturer);
  visit("model_creator", t.model_creator);
  visit("file_creator", t.file_creator);
  visit("equipment", t.equipment);
  visit("camera", t.camera);
  visit("operating_conditions", t.operating_conditions);
  visit("additional_info", t.additional_info);
  visit("geometry_reference", t.geometry_reference);
  visit("additional_text", t.additional_text);
  visit("date", t.date);
}

py::object texts(const Rays& rays) {
  py::dict out;
  visit_texts(rays.set->header.texts, [&](const char* name, const std::string& text) {
    if (!text.empty()) out[name] = text;
  });
  return record(out);
}

/// Header and columns as plain Python objects and arrays, which pickle without loss.
py::tuple state(const py::object& self) {
  const auto& rays = self.cast<const Rays&>();
  const RaySetHeader& h = rays.set->header;
  const RayBlock& b = block(rays);
  py::list arrays, specs;
  for (const auto* column : {&b.x_mm, &b.y_mm, &b.z_mm, &b.kx, &b.ky, &b.kz, &b.weight})
    arrays.append(view(*column, self));
  for (const auto& column : b.extra) arrays.append(view(column, self));
  for (const ColumnSpec& c : h.columns) specs.append(py::make_tuple(static_cast<int>(c.kind), c.label));
  return py::make_tuple(std::string(symbol(h.flux_unit)), h.flux_lm, h.flux_w, specs, spectra(rays),
                        h.wavelength_nm, texts(rays), h.creation_method, h.start_position, arrays,
                        rays.warnings);
}

[[noreturn]] void refuse_state() { throw InputError("a damaged pickle of rays", ErrorCause::damaged); }

/// What a reader of files would refuse too.
void check_state(const RaySetHeader& h, const RayBlock& b) {
  const auto finite = [](const std::vector<float>& column) {
    return std::ranges::all_of(column, [](float x) { return std::isfinite(x); });
  };
  for (const auto* column : {&b.x_mm, &b.y_mm, &b.z_mm, &b.kx, &b.ky, &b.kz, &b.weight})
    if (!finite(*column)) refuse_state();
  if (std::ranges::any_of(b.weight, [](float w) { return w < 0.0F; })) refuse_state();
  for (const SpectralTable& s : h.spectra)
    if (s.wavelength_nm.size() != s.relative_power.size()) refuse_state();
}

Rays from_state(const py::tuple& s) {
  if (s.size() != 11) throw InputError("a pickle of another version of lucerna", ErrorCause::damaged);
  auto set = std::make_shared<RaySet>();
  RaySetHeader& h = set->header;
  h.flux_unit = flux_unit(s[0].cast<std::string>());
  h.flux_lm = s[1].cast<std::optional<double>>();
  h.flux_w = s[2].cast<std::optional<double>>();
  for (const auto& c : s[3].cast<py::list>()) {
    const auto spec = c.cast<py::tuple>();
    const int kind = spec[0].cast<int>();
    if (kind < 0 || kind > static_cast<int>(ColumnKind::additional)) refuse_state();
    h.columns.push_back({static_cast<ColumnKind>(kind), spec[1].cast<std::string>()});
  }
  for (const auto& t : s[4].cast<py::list>()) {
    const auto table = t.cast<py::tuple>();
    h.spectra.push_back({input_row<float>(table[0], "spectrum"), input_row<float>(table[1], "spectrum")});
  }
  h.wavelength_nm = s[5].cast<std::optional<float>>();
  const auto given = s[6].cast<py::dict>();
  visit_texts(h.texts, [&](const char* name, std::string& text) {
    if (given.contains(name)) text = given[name].cast<std::string>();
  });
  h.creation_method = s[7].cast<int>();
  h.start_position = s[8].cast<int>();
  const auto arrays = s[9].cast<py::list>();
  RayBlock& b = set->rays;
  b.extra.resize(h.columns.size());
  std::vector<std::vector<float>*> places{&b.x_mm, &b.y_mm, &b.z_mm, &b.kx, &b.ky, &b.kz, &b.weight};
  for (auto& column : b.extra) places.push_back(&column);
  if (arrays.size() != places.size()) refuse_state();
  if (!arrays.empty()) b.reserve(py::len(arrays[0]));
  for (std::size_t i = 0; i < places.size(); ++i) {
    // Stokes and additional columns may hold what is no number: taken as it is.
    const auto column = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(arrays[i]);
    if (!column || column.ndim() != 1) refuse_state();
    places[i]->assign(column.data(), column.data() + column.size());
    if (places[i]->size() != b.x_mm.size()) refuse_state();
  }
  check_state(h, b);
  return {set, s[10].cast<Warnings>()};
}

Rays read_rays(const std::filesystem::path& path, bool salvage, const std::optional<std::string>& format,
               const std::vector<std::string>& text_columns, const py::object& callback) {
  return watched(callback, OnInterrupt::raise, [&](Watch& watch) {
    Rays rays;
    rays.set = std::make_shared<RaySet>(
        read_ray_set(path, {salvage, format.value_or(std::string()), text_columns}, watch, &rays.warnings));
    return rays;
  });
}

Warnings save_rays(const Rays& rays, const std::filesystem::path& path,
                   const std::optional<std::string>& format, const std::string& length_unit) {
  return released([&] {
    const std::string chosen = ray_format_for(path, format.value_or(std::string()));
    return write_ray_set(path, *rays.set, chosen, {length_unit});
  });
}

Rays make_source(const std::string& kind, double rays, Seed seed, const std::string& sequence,
                 std::optional<double> flux_lm, std::optional<double> flux_w, std::optional<double> radius_mm,
                 std::optional<double> length_mm, const std::optional<std::array<double, 2>>& size_mm,
                 std::optional<double> ghost_share, const std::optional<std::string>& surface,
                 const std::vector<double>& surface_mm) {
  EmitterOptions options;
  options.kind = emitter_kind(kind);
  options.radius_mm = radius_mm;
  options.length_mm = length_mm;
  options.size_mm = size_mm;
  options.ghost_share = ghost_share;
  if (const auto flux = given_flux(flux_lm, flux_w)) {
    options.flux = flux->flux;
    options.flux_unit = flux->unit;
  }
  if (surface) options.surface = BoundingSurface::from_sizes(surface_kind(*surface), surface_mm);
  const std::uint64_t n = ray_count(rays);
  const Sequence numbers(sequence_kind(sequence), seed);
  return released([&] {
    const auto emitter = make_emitter(options);
    auto set = std::make_shared<RaySet>();
    set->header.flux_unit = options.flux_unit;
    set->header.set_flux(options.flux);
    set->rays = sample(*emitter, n, numbers);
    return Rays{set, {}};
  });
}

void add_columns(py::class_<Rays>& c) {
  const auto column = [&](const char* name, std::vector<float> RayBlock::*member, const char* doc) {
    c.def_property_readonly(
        name,
        [member](const py::object& self) { return view(block(self.cast<const Rays&>()).*member, self); },
        doc);
  };
  column("x_mm", &RayBlock::x_mm, "Starts along x, mm: float32 (n,), a read-only view.");
  column("y_mm", &RayBlock::y_mm, "Starts along y, mm: float32 (n,), a read-only view.");
  column("z_mm", &RayBlock::z_mm, "Starts along z, mm: float32 (n,), a read-only view.");
  column("kx", &RayBlock::kx, "Direction cosines along x: float32 (n,), a read-only view.");
  column("ky", &RayBlock::ky, "Direction cosines along y: float32 (n,), a read-only view.");
  column("kz", &RayBlock::kz, "Direction cosines along z: float32 (n,), a read-only view.");
  column("weight", &RayBlock::weight,
         "Relative flux of each ray, as the file has it: float32 (n,), a read-only view.");
  c.def_property_readonly(
      "position_mm",
      [](const py::object& self) { return stacked(self, &RayBlock::x_mm, &RayBlock::y_mm, &RayBlock::z_mm); },
      "Starts, mm: float32 (n, 3), a read-only view across the columns where they lie equally far apart in "
      "memory, as those of large sets do; else a new array at each access.");
  c.def_property_readonly(
      "direction",
      [](const py::object& self) { return stacked(self, &RayBlock::kx, &RayBlock::ky, &RayBlock::kz); },
      "Unit directions: float32 (n, 3), a view or a new array as `position_mm`.");
  c.def_property_readonly("flux", &flux_per_ray,
                          "Flux of each ray in lm (or W): float64 (n,), a new array at each access.");
  c.def_property_readonly("columns", &columns,
                          "Further columns by their labels, each float32 (n,), a read-only view.");
}

}  // namespace

void add_rays(py::module_& m) {
  auto c = py::class_<Rays>(m, "RaySet", kRaySetClassDoc);
  c.def_static("from_arrays", &from_arrays, "position_mm"_a, "direction"_a, py::kw_only(),
               "weight"_a = py::none(), "flux_lm"_a = py::none(), "flux_w"_a = py::none(),
               "wavelength_nm"_a = py::none(), kFromArraysDoc);
  add_columns(c);
  c.def("__len__", [](const Rays& r) { return block(r).size(); });
  c.def(
      "__eq__", [](const Rays& a, const Rays& b) { return a.set == b.set || *a.set == *b.set; },
      py::is_operator());
  c.attr("__hash__") = py::none();
  c.def_property_readonly(
      "unit", [](const Rays& r) { return std::string(symbol(r.set->header.flux_unit)); },
      "Unit of the flux that the weights share: 'lm' or 'W'.");
  c.def_property_readonly(
      "flux_lm", [](const Rays& r) { return r.set->header.flux_lm; },
      "Total luminous flux as it is stated, lm; None where it is not.");
  c.def_property_readonly(
      "flux_w", [](const Rays& r) { return r.set->header.flux_w; },
      "Total radiant flux as it is stated, W; None where it is not.");
  c.def_property_readonly(
      "wavelength_nm", [](const Rays& r) { return r.set->header.wavelength_nm; },
      "The one wavelength of all rays, nm; None where they differ or none is stated.");
  c.def_property_readonly("spectra", &spectra,
                          "Spectra of the file: a list of (wavelength in nm, relative power), both float32.");
  c.def_property_readonly("texts", &texts, "Free text of the file, as a Record.");
  c.def_property_readonly(
      "warnings", [](const Rays& r) { return r.warnings; },
      "What was odd about the file but could be read, one sentence each.");
  c.def("statistics", &statistics, kStatisticsDoc);
  c.def("save", &save_rays, "path"_a, py::kw_only(), "format"_a = py::none(), "length_unit"_a = "mm",
        kSaveDoc);
  c.def(py::pickle(&state, &from_state));

  m.def("read_rays", &read_rays, "path"_a, py::kw_only(), "salvage"_a = false, "format"_a = py::none(),
        "text_columns"_a = Warnings{}, "callback"_a = py::none(), kReadRaysDoc);
  m.def("make_source", &make_source, "kind"_a, "rays"_a, py::kw_only(), "seed"_a = 1, "sequence"_a = "random",
        "flux_lm"_a = py::none(), "flux_w"_a = py::none(), "radius_mm"_a = py::none(),
        "length_mm"_a = py::none(), "size_mm"_a = py::none(), "ghost_share"_a = py::none(),
        "surface"_a = py::none(), "surface_mm"_a = std::vector<double>{}, kMakeSourceDoc);
}

}  // namespace lucerna::python
