// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "call.h"
#include "lucerna/diagram.h"
#include "lucerna/photometric_metrics.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kIntensityDistributionClassDoc =
    R"(Luminous or radiant intensity over the sphere, CIE type C.

Nadir (gamma 0) is -z, C0 is +x, C90 is +y. Between its angles the intensity is bilinear. A distribution never
changes, so threads may share it. It pickles without loss but for the errors of the figures of a trace.

Parameters
----------
c_deg : array_like (planes,)
    C planes, degrees, ascending from 0, below 360.
gamma_deg : array_like (gammas,)
    Angles from nadir, degrees, ascending, 0 to 180, at least two.
cd : array_like (planes, gammas)
    Intensity, >= 0, in `unit`.
unit : str
    'cd' or 'W/sr'.
standard_error : array_like (planes, gammas), optional
    Of each value, in `unit`.
luminaire : mapping, optional
    Fields of the property `luminaire`.)";

constexpr const char* kAtDoc = R"(at(c_deg, gamma_deg)
--

Intensity in any direction, in `unit`.

Parameters
----------
c_deg : array_like
    Any angles, degrees.
gamma_deg : array_like
    0 to 180, degrees; of one shape with c_deg by numpy's rules.

Returns
-------
numpy.ndarray)";

constexpr const char* kMetricsDoc = R"(metrics()
--

Flux, peak, beam and field angles, zones.

Returns
-------
Record
    Numbers where the light was measured, Estimates where it was traced. Angles in degrees, flux in lm (or W),
    intensities in `unit`; None where a threshold is not reached.)";

constexpr const char* kScaledDoc = R"(scaled(factor)
--

The same light with all values multiplied.

Parameters
----------
factor : float
    >= 0.

Returns
-------
IntensityDistribution)";

constexpr const char* kSaveDoc = R"(save(path, *, format=None, ies_turn_deg=0, digits=7)
--

Writes an IES or EULUMDAT file, whole or not at all.

Parameters
----------
path : path_like
    Ends in .ies or .ldt where no format is given.
format : str, optional
    'ldt', 'ies-2019' or 'ies-2002'.
ies_turn_deg : int
    0: H of an IES file is C; 90: H = C - 90, degrees.
digits : int
    Significant digits of the peak; with 17 IES reads back to the same numbers, EULUMDAT to within 1e-13.)";

constexpr const char* kPolarSvgDoc = R"(polar_svg(*, title='')
--

The polar diagram as an SVG document, with 95 % intervals where the errors are known.

Parameters
----------
title : str

Returns
-------
str)";

constexpr const char* kReadIntensityDoc =
    R"(read_intensity(path, *, strict=False, ies_turn_deg=0, isym3='standard')
--

Reads an IES LM-63 or EULUMDAT file, found from its content.

Parameters
----------
path : path_like
strict : bool
    The first repair becomes an InputError.
ies_turn_deg : int
    How the H angles of an IES file are meant: 0, H = C; 90, H = C - 90, degrees.
isym3 : str
    'standard' or 'reversed': how EULUMDAT files of Isym 3 are meant.

Returns
-------
IntensityDistribution

Raises
------
FileNotFoundError, OSError
    Where the file cannot be read.
InputError
    Where it is neither, or damaged; place is the line.)";

}  // namespace

namespace {

namespace fs = std::filesystem;

/// Every field of a luminaire that is a text or a number, with its name.
template <class Luminaire, class Visit>
void visit_luminaire(Luminaire& l, const Visit& visit) {
  visit("manufacturer", l.manufacturer);
  visit("name", l.name);
  visit("catalog_number", l.catalog_number);
  visit("report_number", l.report_number);
  visit("test_lab", l.test_lab);
  visit("date_user", l.date_user);
  visit("file_name", l.file_name);
  visit("length_mm", l.length_mm);
  visit("width_mm", l.width_mm);
  visit("height_mm", l.height_mm);
  visit("luminous_length_mm", l.luminous_length_mm);
  visit("luminous_width_mm", l.luminous_width_mm);
  visit("luminous_height_mm", l.luminous_height_mm);
  visit("absolute", l.absolute);
  visit("input_watts", l.input_watts);
  visit("tilt_deg", l.tilt_deg);
  visit("type_indicator", l.type_indicator);
  visit("direct_ratios", l.direct_ratios);
  visit("keywords", l.keywords);
  visit("generation_type", l.generation_type);
  visit("generation_info", l.generation_info);
}

template <class Lamp, class Visit>
void visit_lamp(Lamp& l, const Visit& visit) {
  visit("count", l.count);
  visit("type", l.type);
  visit("flux_lm", l.flux_lm);
  visit("color", l.color);
  visit("color_rendering", l.color_rendering);
  visit("watts", l.watts);
}

py::object luminaire_record(const LuminaireData& luminaire) {
  py::dict out;
  const auto write = [](py::dict& to) {
    return [&to](const char* name, const auto& value) { to[name] = value; };
  };
  visit_luminaire(luminaire, write(out));
  py::list lamps;
  for (const LampSet& set : luminaire.lamps) {
    py::dict lamp;
    visit_lamp(set, write(lamp));
    lamps.append(record(lamp));
  }
  out["lamps"] = lamps;
  return record(out);
}

LuminaireData luminaire_of(const py::dict& given) {
  LuminaireData out;
  // Takes what it reads away from `from`, so that unknown keys are left.
  const auto read = [](py::dict& from) {
    return [&from](const char* name, auto& value) {
      if (from.contains(name))
        value = from.attr("pop")(name).template cast<std::remove_reference_t<decltype(value)>>();
    };
  };
  const auto check = [](const py::dict& left, const std::string& where) {
    for (const auto& [key, value] : left)
      throw InputError(where + ": found the unknown key " + std::string(py::repr(key)),
                       ErrorCause::unknown_key);
  };
  py::dict keys(given.attr("copy")());
  visit_luminaire(out, read(keys));
  if (keys.contains("lamps")) {
    for (const auto& item : py::list(keys.attr("pop")("lamps"))) {
      py::dict lamp(mapping(py::reinterpret_borrow<py::object>(item), "luminaire: lamps").attr("copy")());
      visit_lamp(out.lamps.emplace_back(), read(lamp));
      check(lamp, "luminaire: lamps");
    }
  }
  check(keys, "luminaire");
  return out;
}

Intensity make_intensity(const py::object& c_deg, const py::object& gamma_deg, const py::object& cd,
                         const std::string& unit, const py::object& standard_error,
                         const py::object& luminaire) {
  auto file = std::make_shared<PhotometricFile>();
  IntensityDistribution& d = file->distribution;
  d.c_deg = input_row<double>(c_deg, "c_deg");
  d.gamma_deg = input_row<double>(gamma_deg, "gamma_deg");
  d.unit = unit == "cd" ? FluxUnit::lumen : FluxUnit::watt;
  if (unit != "cd" && unit != "W/sr") throw InputError("unit: found '" + unit + "', expected 'cd' or 'W/sr'");
  const Shape shape = grid(d.c_deg.size(), d.gamma_deg.size());
  const auto values = [&](const py::object& given, const char* name) {
    const auto array = input<double>(given, name);
    if (shape_of(array) != shape)
      throw InputError(std::string(name) + ": found shape " + shape_text(array) + ", expected (" +
                       std::to_string(shape[0]) + ", " + std::to_string(shape[1]) + "), C by gamma");
    return std::vector<double>(array.data(), array.data() + array.size());
  };
  d.cd = values(cd, "cd");
  if (const std::string fault = grid_fault(d); !fault.empty()) throw InputError(fault);
  Intensity out{file};
  if (!standard_error.is_none()) out.standard_error = values(standard_error, "standard_error");
  for (const double e : out.standard_error) {
    if (e < 0.0) throw InputError("standard_error: found " + std::to_string(e) + ", expected none below 0");
  }
  if (!luminaire.is_none()) file->luminaire = luminaire_of(mapping(luminaire, "luminaire"));
  return out;
}

PhotometricReadOptions read_options(bool strict, int ies_turn_deg, const std::string& isym3) {
  PhotometricReadOptions options;
  options.strict = strict;
  if (ies_turn_deg != 0 && ies_turn_deg != 90)
    throw InputError("ies_turn_deg: found " + std::to_string(ies_turn_deg) + ", expected 0 or 90");
  if (ies_turn_deg == 90) options.ies_turn = IesTurn::minus_90;
  if (isym3 != "standard" && isym3 != "reversed")
    throw InputError("isym3: found '" + isym3 + "', expected 'standard' or 'reversed'");
  if (isym3 == "reversed") options.isym3 = Isym3Order::reversed;
  return options;
}

Intensity read_intensity(const fs::path& path, bool strict, int ies_turn_deg, const std::string& isym3) {
  const PhotometricReadOptions options = read_options(strict, ies_turn_deg, isym3);
  return released(
      [&] { return Intensity{std::make_shared<PhotometricFile>(read_photometric_file(path, options))}; });
}

PhotometricFormat format_of(const fs::path& path, const std::optional<std::string>& format) {
  const std::string ending = path.extension().string();
  const std::string name = format             ? *format
                           : ending == ".ldt" ? "ldt"
                           : ending == ".ies" ? "ies-2019"
                                              : ending;
  if (name == "ldt") return PhotometricFormat::ldt;
  if (name == "ies-2019") return PhotometricFormat::ies_2019;
  if (name == "ies-2002") return PhotometricFormat::ies_2002;
  throw UsageError("format: found '" + name + "', expected 'ldt', 'ies-2019' or 'ies-2002'", "format");
}

void save_intensity(const Intensity& intensity, const fs::path& path,
                    const std::optional<std::string>& format, int ies_turn_deg, int digits) {
  PhotometricWriteOptions options;
  options.ies_turn = read_options(false, ies_turn_deg, "standard").ies_turn;
  if (digits < 1 || digits > 17)
    throw InputError("digits: found " + std::to_string(digits) + ", expected 1 to 17",
                     ErrorCause::out_of_range);
  options.digits = digits;
  const PhotometricFormat chosen = format_of(path, format);
  released([&] {
    write_photometric_file(path, *intensity.file, chosen, options);
    return 0;
  });
}

py::array_t<double> at(const Intensity& intensity, const py::object& c_deg, const py::object& gamma_deg) {
  const Pair angles = input_pair(c_deg, "c_deg", gamma_deg, "gamma_deg");
  const auto n = static_cast<std::size_t>(angles.first.size());
  std::vector<double> out(n);
  const double *c = angles.first.data(), *g = angles.second.data();
  released([&] {
    for (std::size_t i = 0; i < n; ++i) {
      if (!(g[i] >= 0.0 && g[i] <= 180.0))
        throw InputError("gamma_deg: found " + std::to_string(g[i]) + ", expected 0 to 180",
                         ErrorCause::out_of_range);
      out[i] = intensity_at(intensity.values(), c[i], g[i]);
    }
    return 0;
  });
  return owned(std::move(out), shape_of(angles.first));
}

/// Figures with or without errors look alike to a user.
template <class Metrics>
py::list plane_angles(const std::vector<typename Metrics::Plane>& planes) {
  py::list out;
  const auto angle = [](const auto& value) {
    if constexpr (std::is_same_v<Metrics, FarFieldMetrics>) {
      return estimate(value);
    } else {
      return py::cast(value);
    }
  };
  for (const auto& p : planes) {
    py::dict plane;
    plane["c_deg"] = p.c_deg;
    plane["beam_of_maximum_deg"] = angle(p.beam_of_maximum);
    plane["field_of_maximum_deg"] = angle(p.field_of_maximum);
    plane["beam_of_centre_deg"] = angle(p.beam_of_centre);
    plane["field_of_centre_deg"] = angle(p.field_of_centre);
    out.append(record(plane));
  }
  return out;
}

py::object traced_metrics(const FarFieldMetrics& m) {
  py::dict out;
  out["flux"] = estimate(m.flux);
  out["peak_cd"] = m.peak ? estimate(m.peak->cd) : py::none();
  out["peak_c_deg"] = m.peak ? estimate(m.peak->c_deg) : py::none();
  out["peak_gamma_deg"] = m.peak ? estimate(m.peak->gamma_deg) : py::none();
  out["axis_gamma_deg"] = m.axis_gamma_deg;
  out["centre_cd"] = estimate(m.axis_cd);
  out["planes"] = plane_angles<FarFieldMetrics>(m.planes);
  out["cut_off_deg"] = estimate(m.cut_off_deg);
  out["zonal"] = estimates(m.zonal);
  out["flux_0_30"] = estimate(m.flux_0_30);
  out["flux_0_40"] = estimate(m.flux_0_40);
  out["flux_0_60"] = estimate(m.flux_0_60);
  out["flux_60_90"] = estimate(m.flux_60_90);
  out["flux_0_90"] = estimate(m.flux_0_90);
  out["flux_90_180"] = estimate(m.flux_90_180);
  out["cie_flux_code"] = estimates(m.cie_flux_code);
  return record(out);
}

py::object file_metrics(const PhotometricFile& file) {
  const PhotometricMetrics m = photometric_metrics(file);
  py::dict out;
  out["flux"] = m.beam.flux;
  out["peak_cd"] = m.beam.peak.cd;
  out["peak_c_deg"] = m.beam.peak.c_deg;
  out["peak_gamma_deg"] = m.beam.peak.gamma_deg;
  out["axis_gamma_deg"] = m.beam.axis_gamma_deg;
  out["centre_cd"] = m.beam.centre_cd;
  out["planes"] = plane_angles<BeamMetrics>(m.beam.planes);
  out["cut_off_deg"] = m.cut_off_deg;
  out["zonal"] = m.zonal;
  out["flux_0_30"] = m.flux_0_30;
  out["flux_0_40"] = m.flux_0_40;
  out["flux_0_60"] = m.flux_0_60;
  out["flux_60_90"] = m.flux_60_90;
  out["flux_0_90"] = m.flux_0_90;
  out["flux_90_180"] = m.flux_90_180;
  out["cie_flux_code"] = m.cie_flux_code;
  out["light_output_ratio"] = m.light_output_ratio;
  out["nema_horizontal"] = m.nema_horizontal;
  out["nema_vertical"] = m.nema_vertical;
  return record(out);
}

py::object intensity_error(const py::object& self) {
  const auto& i = self.cast<const Intensity&>();
  if (i.standard_error.empty()) return py::none();
  return view(i.standard_error, grid(i.values().c_deg.size(), i.values().gamma_deg.size()), self);
}

Intensity scaled(const Intensity& intensity, double factor) {
  if (!(factor >= 0.0 && std::isfinite(factor)))
    throw InputError("factor: found " + std::to_string(factor) + ", expected a finite number >= 0",
                     ErrorCause::out_of_range);
  auto file = std::make_shared<PhotometricFile>(*intensity.file);
  scale(file->distribution, factor);
  Intensity out{file, intensity.standard_error};
  for (double& e : out.standard_error) e *= factor;
  const auto is_finite = [](double value) { return std::isfinite(value); };
  for (const auto* values : {&file->distribution.cd, &out.standard_error}) {
    if (!std::all_of(values->begin(), values->end(), is_finite))
      throw InputError("factor: found " + std::to_string(factor) + ", which makes values infinite",
                       ErrorCause::out_of_range);
  }
  return out;
}

Warnings intensity_warnings(const Intensity& i) {
  Warnings out;
  for (const auto* list : {&i.file->repairs, &i.file->notes}) {
    for (const Diagnostic& d : *list) out.push_back(to_string(d));
  }
  return out;
}

bool equal(const Intensity& a, const Intensity& b) {
  const IntensityDistribution &x = a.values(), &y = b.values();
  return x.c_deg == y.c_deg && x.gamma_deg == y.gamma_deg && x.cd == y.cd && x.unit == y.unit &&
         a.standard_error == b.standard_error;
}

void add_values(py::class_<Intensity>& c) {
  c.def_property_readonly(
      "c_deg",
      [](const py::object& self) { return view(self.cast<const Intensity&>().values().c_deg, self); },
      "C planes, degrees, ascending from 0: float64 (planes,), a read-only view. One plane is rotational.");
  c.def_property_readonly(
      "gamma_deg",
      [](const py::object& self) { return view(self.cast<const Intensity&>().values().gamma_deg, self); },
      "gamma angles, degrees, ascending: float64 (gammas,), a read-only view. 0 is nadir.");
  c.def_property_readonly(
      "cd",
      [](const py::object& self) {
        const IntensityDistribution& d = self.cast<const Intensity&>().values();
        return view(d.cd, grid(d.c_deg.size(), d.gamma_deg.size()), self);
      },
      "Intensity, cd (W/sr for radiometric light): float64 (planes, gammas), a read-only view.");
  c.def_property_readonly("standard_error", &intensity_error,
                          "Standard error of each value, in its unit, or None: float64 (planes, gammas).");
  c.def_property_readonly(
      "unit", [](const Intensity& i) { return i.values().unit == FluxUnit::lumen ? "cd" : "W/sr"; },
      "Unit of the values: 'cd' or 'W/sr'.");
  c.def_property_readonly(
      "flux",
      [](const Intensity& i) {
        return i.flux ? estimate(*i.flux) : py::object(py::float_(total_flux(i.values())));
      },
      "Total flux, lm (or W): an Estimate where the light was traced, else a float.");
  c.def_property_readonly(
      "luminaire", [](const Intensity& i) { return luminaire_record(i.file->luminaire); },
      "What the file says of the luminaire, as a Record; lengths in mm.");
  c.def_property_readonly("warnings", &intensity_warnings,
                          "What was repaired or assumed in reading the file, one sentence each.");
}

}  // namespace

py::object intensity_metrics(const Intensity& i) {
  if (i.figures) return i.figures->get();
  if (!i.trace) return file_metrics(*i.file);
  const Traced::Figures exact = released([&] { return i.trace->far_fields(); });
  return traced_metrics(exact->far_fields[i.far_field].metrics);
}

namespace {

/// Of a pickle: the same values with the figures that their trace had.
Intensity with_figures(const Intensity& values, const std::array<double, 2>& flux,
                       const py::object& metrics) {
  Intensity out = values;
  out.flux = Estimate{flux[0], flux[1]};
  out.figures = std::make_shared<const Kept>(metrics);
  return out;
}

}  // namespace

void add_intensity(py::module_& m) {
  auto c = py::class_<Intensity>(m, "IntensityDistribution", kIntensityDistributionClassDoc);
  c.def(py::init(&make_intensity), "c_deg"_a, "gamma_deg"_a, "cd"_a, py::kw_only(), "unit"_a = "cd",
        "standard_error"_a = py::none(), "luminaire"_a = py::none(),
        "__init__(self, c_deg, gamma_deg, cd, *, unit='cd', standard_error=None, luminaire=None)\n--\n\n");
  add_values(c);
  c.def("at", &at, "c_deg"_a, "gamma_deg"_a, kAtDoc);
  c.def("metrics", &intensity_metrics, kMetricsDoc);
  c.def("scaled", &scaled, "factor"_a, kScaledDoc);
  c.def("save", &save_intensity, "path"_a, py::kw_only(), "format"_a = py::none(), "ies_turn_deg"_a = 0,
        "digits"_a = 7, kSaveDoc);
  c.def(
      "polar_svg",
      [](const Intensity& i, const std::string& title) {
        return polar_diagram(i.values(), i.standard_error, title);
      },
      py::kw_only(), "title"_a = "", kPolarSvgDoc);
  c.def("__eq__", &equal, py::is_operator());
  c.attr("__hash__") = py::none();
  c.def("__reduce__", [](const py::object& self) {
    const auto& i = self.cast<const Intensity&>();
    const py::object flux =
        i.flux ? py::object(py::make_tuple(i.flux->mean, i.flux->standard_error)) : py::none();
    return py::make_tuple(
        python_name("lucerna._types", "make_intensity"),
        py::make_tuple(self.attr("c_deg"), self.attr("gamma_deg"), self.attr("cd"), self.attr("unit"),
                       self.attr("standard_error"), luminaire_record(i.file->luminaire), flux,
                       i.flux ? intensity_metrics(i) : py::none()));
  });
  m.def("_with_figures", &with_figures);
  m.def("read_intensity", &read_intensity, "path"_a, py::kw_only(), "strict"_a = false, "ies_turn_deg"_a = 0,
        "isym3"_a = "standard", kReadIntensityDoc);
}

}  // namespace lucerna::python
