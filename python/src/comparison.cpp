// SPDX-License-Identifier: Apache-2.0
#include "lucerna/comparison.h"

#include <pybind11/stl/filesystem.h>

#include "call.h"
#include "lucerna/build_info.h"
#include "lucerna/intensity_comparison.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/report.h"
#include "record.h"
#include "types.h"

namespace lucerna::python {

using namespace py::literals;

namespace {

// What `help` says of each; signatures are in a form that `inspect` reads.

constexpr const char* kWriteReportDoc = R"(write_report(input, html, *, ray_files=[], callback=None)
--

Writes one self-contained HTML file of a trace, a design or a model.

Parameters
----------
input : path_like
    The folder of a trace or design, or a model (.nfl).
html : path_like
    The file to write.
ray_files : list of path_like
    For a model: the ray files that it is compared with.
callback : callable, optional
    Gets a Record with phase, done and total (rays), ten times a second at most.)";

constexpr const char* kBuildInfoDoc = R"(build_info()
--

What this build is, and what it uses on this machine.

Returns
-------
Record
    version, compiler, isa (instruction set), threads, embree (bool), cuda_unavailable (why no CUDA device can
    be used; None where one can).)";

}  // namespace

py::object view_record(const ViewDifference& v) {
  py::dict out;
  out["error"] = v.error;
  out["floor"] = v.floor;
  out["excess"] = estimate(Estimate{v.excess, v.standard_error});
  out["raw"] = v.raw;
  return record(out);
}

py::object views_record(const RaySetComparison& all) {
  py::dict out;
  for (const ViewKind kind : kViewKinds) out[py::str(std::string(to_string(kind)))] = view_record(all[kind]);
  return record(out);
}

namespace {

namespace fs = std::filesystem;

py::object distributions_record(const DistributionComparison& d, bool with_errors) {
  py::dict out;
  const auto add = [&](const char* name, const Estimate& e) {
    out[name] = with_errors ? estimate(e) : py::object(py::float_(e.mean));
  };
  add("relative_rms", d.relative_rms);
  add("bergen_fit", d.bergen_fit);
  add("flux_ratio", d.flux_ratio);
  add("peak_ratio", d.peak_ratio);
  add("wasserstein_deg", d.wasserstein_deg);
  add("overlap", d.overlap);
  out["noise_floor"] = d.noise_floor;
  add("excess", d.excess);
  return record(out);
}

py::object compare_rays(const Rays& reference, const Rays& test) {
  return views_record(released([&] { return compare_ray_sets(reference.set->rays, test.set->rays); }));
}

py::object compare_intensities(const Intensity& reference, const Intensity& test) {
  const bool with_errors = !reference.standard_error.empty() || !test.standard_error.empty();
  const DistributionComparison found = released([&] {
    return compare_distributions(reference.values(), test.values(),
                                 {.reference_error_cd = reference.standard_error,
                                  .test_error_cd = test.standard_error,
                                  .align = false});
  });
  return distributions_record(found, with_errors);
}

py::object compare_files(const fs::path& reference, const fs::path& test, double rays, Seed seed,
                         const py::object& callback) {
  FileComparisonOptions options;
  options.rays = ray_count(rays);
  options.seed = seed;
  const FileComparison found = watched(
      callback, OnInterrupt::raise, [&](Watch& watch) { return compare(reference, test, options, watch); });
  if (found.rays) return views_record(found.rays->views);
  py::object out = distributions_record(found.light->distributions, true);
  out["boxes"] = design_error(found.light->boxes);
  return out;
}

py::object build_record() {
  const BuildInfo info = build_info();
  py::dict out;
  out["version"] = info.version;
  out["compiler"] = info.compiler;
  out["isa"] = info.isa;
  out["threads"] = info.threads;
  out["embree"] = info.embree;
  out["cuda_unavailable"] =
      info.cuda_unavailable.empty() ? py::object(py::none()) : py::object(py::str(info.cuda_unavailable));
  return record(out);
}

}  // namespace

void add_comparison(py::module_& m) {
  m.def("_compare_rays", &compare_rays);
  m.def("_compare_intensities", &compare_intensities);
  m.def("_compare_files", &compare_files);
  m.def(
      "write_report",
      [](const fs::path& input, const fs::path& html, const std::vector<fs::path>& ray_files,
         const py::object& callback) {
        watched(callback, OnInterrupt::raise, [&](Watch& watch) {
          write_report(input, html, ray_files, watch);
          return 0;
        });
      },
      "input"_a, "html"_a, py::kw_only(), "ray_files"_a = std::vector<fs::path>{}, "callback"_a = py::none(),
      kWriteReportDoc);
  m.def("build_info", &build_record, kBuildInfoDoc);
  m.def(
      "estimate_text",
      [](double value, double standard_error, const std::string& unit) {
        return estimate_text({value, standard_error}, unit);
      },
      "value"_a, "standard_error"_a, "unit"_a = "");
}

}  // namespace lucerna::python
