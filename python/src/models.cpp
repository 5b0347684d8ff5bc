// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <variant>

#include "call.h"
#include "lucerna/held_out.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kPdfAreaDoc = R"(pdf_area(points_mm, *, copy=True)
--

Density of starts, 1/mm2 on the surface that rays start on; 0 off it.

Parameters
----------
points_mm : array_like (..., 3)
    Points, mm.
copy : bool
    False raises where an array would have to be copied.

Returns
-------
numpy.ndarray (...)

Raises
------
InputError
    Where starts fill no area (a point, a line).)";

constexpr const char* kPdfSolidAngleDoc = R"(pdf_solid_angle(points_mm, directions, *, copy=True)
--

Density of directions at a start, 1/sr.

Parameters
----------
points_mm, directions : array_like (..., 3)
    Points, mm, and directions of any length; of one shape by numpy's rules.
copy : bool
    False raises where an array would have to be copied.

Returns
-------
numpy.ndarray (...))";

constexpr const char* kPdfEtendueDoc = R"(pdf_etendue(points_mm, directions, *, copy=True)
--

Density of rays, 1/(mm2 sr), projected.

Parameters
----------
points_mm, directions : array_like (..., 3)
    Points, mm, and directions of any length; of one shape by numpy's rules.
copy : bool
    False raises where an array would have to be copied.

Returns
-------
numpy.ndarray (...))";

constexpr const char* kLuminanceDoc = R"(luminance(points_mm, directions, *, copy=True)
--

Luminance of the source along rays, cd/m2 (W/(m2 sr) for radiometric models).

Parameters
----------
points_mm, directions : array_like (..., 3)
    Points, mm, and the directions that the light goes in; of one shape by numpy's rules.
copy : bool
    False raises where an array would have to be copied.

Returns
-------
numpy.ndarray (...))";

constexpr const char* kSourceModelClassDoc = R"(A ray set compressed to a density of rays.

Any number of rays can be drawn from it, and the density of each is known. A model never changes, so threads
may share it. It pickles as the bytes of its file.)";

constexpr const char* kSampleDoc = R"(sample(rays, *, seed=1, sequence='random')
--

Draws rays: the same ones for the same seed, on any number of threads.

Parameters
----------
rays : int
    How many; 1e6 is taken, too.
seed : int
    Of the random numbers.
sequence : str
    'random' (independent) or 'sobol' (evenly spread).

Returns
-------
RaySet
    Its total flux is the model's.)";

constexpr const char* kSampleFileDoc =
    R"(sample_file(path, rays, *, seed=1, sequence='random', format=None, callback=None)
--

Draws rays into a file, in memory that does not grow with it.

They are the rays that `lucerna sample` writes. Where the format's header says what they were sampled from, it
is the file's name there, and 'a model' here.

Parameters
----------
path : path_like
rays : int
    How many; 1e9 is taken, too.
seed, sequence
    As of `sample`.
format : str, optional
    As of `RaySet.save`.
callback : callable, optional
    Gets a Record with phase, done and total (rays), ten times a second at most.

Returns
-------
list of str
    What the format cannot hold.)";

constexpr const char* kEtendueMm2srDoc = R"(etendue_mm2sr(shares, *, rays=16384, seed=1)
--

Étendue that holds the brightest shares of the flux, mm2 sr.

Parameters
----------
shares : array_like (n,)
    Shares of the flux, 0 to 1.
rays : int
    Rays that it is estimated from; the noise is about 1 / sqrt(rays).
seed : int
    Of these rays.

Returns
-------
numpy.ndarray (n,))";

constexpr const char* kSaveDoc = R"(save(path)
--

Writes the model as a file (.nfl), whole or not at all.

Parameters
----------
path : path_like

Returns
-------
int
    Bytes of the file.)";

constexpr const char* kCompressDoc =
    R"(compress(rays, *, method='adaptive', max_bytes=None, flux_lm=None, flux_w=None, seed=1,
    callback=None)
--

Makes a source model of rays.

Parameters
----------
rays : RaySet, path_like or list of path_like
    Files are read block by block, so that they may be larger than memory; several are superposed.
method : str
    'adaptive' or 'clusters'.
max_bytes : int or str, optional
    Ceiling of the model's file: 64000, '64k', '64KiB'. As many as the rays justify where it is not given.
flux_lm, flux_w : float, optional
    Total flux of the model, lm or W; what the rays' file states where it is not given.
seed : int
    Of the random choices; the same seed gives the same model.
callback : callable, optional
    Gets a Record with phase, done and total, ten times a second at most.

Returns
-------
SourceModel

Raises
------
InputError
    Without rays or flux, or where max_bytes is too little.
KeyboardInterrupt
    On Ctrl-C.)";

constexpr const char* kCompareHeldOutDoc =
    R"(compare_held_out(rays, *, max_rays=2000000.0, method='adaptive', max_bytes=None, seed=1, callback=None)
--

Deals rays out by chance to two halves, makes a model of one and compares it with the other.

Says how good a model of such rays is. A model of all of them has twice as many to learn from.

Parameters
----------
rays : RaySet, path_like or list of path_like
    Several files are superposed.
max_rays : int
    Of more rays in files so many are taken, spread over the files. A RaySet is taken whole.
method, max_bytes, seed
    As of compress.
callback : callable, optional
    Gets a Record with phase, done and total, ten times a second at most.

Returns
-------
Record or None
    training_rays; held_out_rays; views (as of compare; raw is the noise of the training half); scales: five
    Records of illuminance on the plane through the virtual focus, with cell_mm (edge of the cells, smallest
    first), error, floor, excess and raw. None where a half has fewer than 100 rays or no flux.

Raises
------
InputError
    Without rays, or where max_bytes is too little.
KeyboardInterrupt
    On Ctrl-C.)";

constexpr const char* kReadModelDoc = R"(read_model(path)
--

Reads a source model (.nfl) of any version.

Parameters
----------
path : path_like

Returns
-------
SourceModel

Raises
------
FileNotFoundError, OSError
    Where the file cannot be read.
InputError
    Where it is no model, or damaged.)";

}  // namespace

namespace {

namespace fs = std::filesystem;

/// Wavelengths are drawn in blocks of so many.
constexpr std::size_t kWavelengthBlock = std::size_t{1} << 16;

/// A number of bytes: 64000, "64k", "1MB", "64KiB".
std::optional<std::uint64_t> byte_count(const py::object& given) {
  if (given.is_none()) return std::nullopt;
  return python_name("lucerna._types", "byte_count")(given).cast<std::uint64_t>();
}

using RaysOrFiles = std::variant<Rays, fs::path, std::vector<fs::path>>;

/// Of rays that are no set.
std::vector<fs::path> files_of(const RaysOrFiles& rays) {
  const auto* file = std::get_if<fs::path>(&rays);
  return file != nullptr ? std::vector<fs::path>{*file} : std::get<std::vector<fs::path>>(rays);
}

CompressOptions compress_options(const std::string& method, const py::object& max_bytes, Seed seed) {
  CompressOptions options;
  options.method = compress_method(method);
  options.max_bytes = byte_count(max_bytes);
  options.seed = seed;
  return options;
}

Model compress_any(const RaysOrFiles& rays, const std::string& method, const py::object& max_bytes,
                   std::optional<double> flux_lm, std::optional<double> flux_w, Seed seed,
                   const py::object& callback) {
  CompressOptions options = compress_options(method, max_bytes, seed);
  const std::optional<GivenFlux> flux = given_flux(flux_lm, flux_w);
  if (flux) options.flux = flux->flux;
  return watched(callback, OnInterrupt::raise, [&](Watch& watch) -> Model {
    Model made;
    if (const auto* set = std::get_if<Rays>(&rays)) {
      made = {compress(*set->set, options, watch), {}};
    } else {
      CompressedFiles found = compress(files_of(rays), options, watch);
      made = {std::move(found.model), std::move(found.warnings)};
      made.warnings.insert(made.warnings.end(), found.notes.begin(), found.notes.end());
    }
    if (flux && made.model->flux_unit() != flux->unit)
      throw InputError("flux: found " + std::string(symbol(flux->unit)) + ", expected " +
                       std::string(symbol(made.model->flux_unit())) + ", the unit of the rays");
    return made;
  });
}

py::object held_out(const RaysOrFiles& rays, double max_rays, const std::string& method,
                    const py::object& max_bytes, Seed seed, const py::object& callback) {
  const CompressOptions options = compress_options(method, max_bytes, seed);
  const std::uint64_t most = ray_count(max_rays);
  const auto found = watched(callback, OnInterrupt::raise, [&](Watch& watch) {
    if (const auto* set = std::get_if<Rays>(&rays)) return compare_held_out(*set->set, options, watch);
    return compare_held_out(files_of(rays), most, options, watch);
  });
  if (!found) return py::none();
  py::list scales;
  for (const ScaleDifference& scale : found->scales) {
    py::dict fields(view_record(scale.difference));
    fields["cell_mm"] = scale.cell_mm;
    scales.append(record(fields));
  }
  py::dict out;
  out["training_rays"] = found->training_rays;
  out["held_out_rays"] = found->held_out_rays;
  out["views"] = views_record(found->views);
  out["scales"] = py::tuple(scales);
  return record(out);
}

Rays sample_model(const Model& model, double rays, Seed seed, const std::string& sequence) {
  const std::uint64_t n = ray_count(rays);
  if (n == 0) throw InputError("rays: found 0, expected at least one", ErrorCause::out_of_range);
  const Sequence numbers(sequence_kind(sequence), seed);
  return released([&] {
    const SourceModel& source = *model.model;
    auto set = std::make_shared<RaySet>();
    set->header.flux_unit = source.flux_unit();
    set->header.set_flux(source.flux());
    set->header.spectra.assign(source.spectra().begin(), source.spectra().end());
    set->rays = sample(source, n, numbers);
    if (source.has_wavelengths()) {
      std::vector<float> nm(n);
      for (std::size_t first = 0; first < n; first += kWavelengthBlock)
        source.emit_wavelengths(numbers, first,
                                std::span(nm).subspan(first, std::min(kWavelengthBlock, n - first)));
      set->header.columns.push_back({ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)});
      set->rays.extra.push_back(std::move(nm));
    }
    return Rays{set, {}};
  });
}

Warnings sample_file(const Model& model, const fs::path& path, double rays, Seed seed,
                     const std::string& sequence, const std::optional<std::string>& format,
                     const py::object& callback) {
  SampleOptions options;
  options.seed = seed;
  options.sequence = sequence_kind(sequence);
  options.format = format.value_or(std::string());
  const std::uint64_t n = ray_count(rays);
  return watched(callback, OnInterrupt::raise,
                 [&](Watch& watch) { return sample(*model.model, n, path, options, watch); });
}

/// `value(point, direction)` for each of two arrays of vectors, which numpy brings to one shape.
template <class Value>
py::array_t<double> for_each_ray(const py::object& points_mm, const py::object& directions, bool copy,
                                 const Value& value) {
  auto points = input_vectors<double>(points_mm, "points_mm", copy);
  auto ways = input_vectors<double>(directions, "directions", copy);
  // One vector goes with all of the other array without being repeated in memory.
  std::size_t point_step = 1, way_step = 1;
  if (shape_of(points) != shape_of(ways)) {
    if (points.ndim() == 1) {
      point_step = 0;
    } else if (ways.ndim() == 1) {
      way_step = 0;
    } else {
      if (!copy)
        throw InputError("points_mm and directions: found shapes " + shape_text(points) + " and " +
                         shape_text(ways) + ", which have to be copied, expected one where copy=False");
      const py::tuple both = py::module_::import("numpy").attr("broadcast_arrays")(points, ways);
      points = input_vectors<double>(both[0], "points_mm");
      ways = input_vectors<double>(both[1], "directions");
    }
  }
  const py::array& all = point_step == 0 ? ways : points;
  std::vector<double> out(vector_count(all));
  const double *p = points.data(), *k = ways.data();
  released([&] {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec3 way = vector_at(k, way_step * i);
      if (!(length(way) > 0.0))
        throw InputError("directions: found a vector of length 0, expected directions");
      out[i] = value(vector_at(p, point_step * i), Direction::from(way));
    }
    return 0;
  });
  return owned(std::move(out), shape_of_vectors(all));
}

py::array_t<double> pdf_area(const Model& model, const py::object& points_mm, bool copy) {
  const auto points = input_vectors<double>(points_mm, "points_mm", copy);
  std::vector<double> out(vector_count(points));
  const double* p = points.data();
  released([&] {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = model.model->pdf_area(vector_at(p, i));
    return 0;
  });
  return owned(std::move(out), shape_of_vectors(points));
}

void add_densities(py::class_<Model>& c) {
  c.def("pdf_area", &pdf_area, "points_mm"_a, py::kw_only(), "copy"_a = true, kPdfAreaDoc);
  c.def(
      "pdf_solid_angle",
      [](const Model& m, const py::object& points, const py::object& directions, bool copy) {
        return for_each_ray(points, directions, copy, [&](const Vec3& p, const Direction& d) {
          return m.model->pdf_solid_angle(p, d);
        });
      },
      "points_mm"_a, "directions"_a, py::kw_only(), "copy"_a = true, kPdfSolidAngleDoc);
  c.def(
      "pdf_etendue",
      [](const Model& m, const py::object& points, const py::object& directions, bool copy) {
        return for_each_ray(points, directions, copy, [&](const Vec3& p, const Direction& d) {
          return m.model->pdf_etendue({p, d});
        });
      },
      "points_mm"_a, "directions"_a, py::kw_only(), "copy"_a = true, kPdfEtendueDoc);
  c.def(
      "luminance",
      [](const Model& m, const py::object& points, const py::object& directions, bool copy) {
        // Of flux per mm2 and sr to flux per m2 and sr.
        const double per_density = 1e6 * m.model->flux();
        return for_each_ray(points, directions, copy, [&](const Vec3& p, const Direction& d) {
          return per_density * m.model->pdf_etendue({p, d});
        });
      },
      "points_mm"_a, "directions"_a, py::kw_only(), "copy"_a = true, kLuminanceDoc);
}

py::array_t<double> model_etendue(const Model& model, const py::object& shares, double rays, Seed seed) {
  const std::vector<double> given = input_row<double>(shares, "shares");
  const std::uint64_t n = ray_count(rays);
  if (n == 0) throw InputError("rays: found 0, expected at least one", ErrorCause::out_of_range);
  return owned(released([&] { return etendue_mm2sr(*model.model, given, n, seed); }));
}

void add_facts(py::class_<Model>& c) {
  const auto fact = [&](const char* name, auto get, const char* doc) {
    c.def_property_readonly(
        name, [get](const Model& m) { return get(*m.model); }, doc);
  };
  fact(
      "flux", [](const SourceModel& m) { return m.flux(); }, "Total flux in `unit`.");
  fact(
      "unit", [](const SourceModel& m) { return std::string(symbol(m.flux_unit())); },
      "Unit of the flux: 'lm' or 'W'.");
  fact(
      "method", [](const SourceModel& m) { return std::string(m.method()); }, "'adaptive' or 'clusters'.");
  fact(
      "layers", [](const SourceModel& m) { return m.layers(); }, "Supports that rays start on.");
  fact(
      "leaves", [](const SourceModel& m) { return m.leaves(); }, "Constant pieces of density.");
  fact(
      "training_rays", [](const SourceModel& m) { return m.training_rays(); },
      "Rays that the model was made from; 0 where that is not known.");
  fact(
      "has_wavelengths", [](const SourceModel& m) { return m.has_wavelengths(); },
      "Whether sampled rays have wavelengths.");
  c.def_property_readonly(
      "warnings", [](const Model& m) { return m.warnings; },
      "What was odd about the ray files but could be read, one sentence each.");
}

Model load(const fs::path& path) {
  return released([&] { return Model{load_source_model(path), {}}; });
}

}  // namespace

void add_models(py::module_& m) {
  auto c = py::class_<Model>(m, "SourceModel", kSourceModelClassDoc);
  add_facts(c);
  c.def("sample", &sample_model, "rays"_a, py::kw_only(), "seed"_a = 1, "sequence"_a = "random", kSampleDoc);
  c.def("sample_file", &sample_file, "path"_a, "rays"_a, py::kw_only(), "seed"_a = 1, "sequence"_a = "random",
        "format"_a = py::none(), "callback"_a = py::none(), kSampleFileDoc);
  add_densities(c);
  c.def("etendue_mm2sr", &model_etendue, "shares"_a, py::kw_only(), "rays"_a = 16384, "seed"_a = 1,
        kEtendueMm2srDoc);
  c.def(
      "save",
      [](const Model& model, const fs::path& path) {
        return released([&] { return save_source_model(path, *model.model); });
      },
      "path"_a, kSaveDoc);
  c.def(py::pickle(
      [](const Model& model) {
        return py::make_tuple(py::bytes(source_model_bytes(*model.model)), model.warnings);
      },
      [](const py::tuple& state) {
        if (state.size() != 2)
          throw InputError("a pickle of another version of lucerna", ErrorCause::damaged);
        return Model{source_model_from_bytes(state[0].cast<std::string>(), "pickle"),
                     state[1].cast<Warnings>()};
      }));
  c.def(
      "__eq__",
      [](const Model& a, const Model& b) {
        return a.model == b.model || source_model_bytes(*a.model) == source_model_bytes(*b.model);
      },
      py::is_operator());
  c.attr("__hash__") = py::none();

  m.def("compress", &compress_any, "rays"_a, py::kw_only(), "method"_a = "adaptive",
        "max_bytes"_a = py::none(), "flux_lm"_a = py::none(), "flux_w"_a = py::none(), "seed"_a = 1,
        "callback"_a = py::none(), kCompressDoc);
  m.def("compare_held_out", &held_out, "rays"_a, py::kw_only(), "max_rays"_a = 2e6, "method"_a = "adaptive",
        "max_bytes"_a = py::none(), "seed"_a = 1, "callback"_a = py::none(), kCompareHeldOutDoc);
  m.def("read_model", &load, "path"_a, kReadModelDoc);
}

}  // namespace lucerna::python
