// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/rays.h"
#include "lucerna/source.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Sections of a model file; opaque to users of the library.
struct NflFile;

/// A ray set compressed to a density of rays: any number of rays can be drawn, and the density of each is
/// known. Whatever the method, a model is immutable and thread safe, and the same file gives the same rays to
/// the bit.
class SourceModel : public RaySource {
 public:
  /// "clusters" or "adaptive".
  virtual std::string_view method() const = 0;
  /// Supports that rays start on.
  virtual std::size_t layers() const = 0;
  /// Constant pieces of density that are stored.
  virtual std::size_t leaves() const = 0;
  /// Rays that the model was made from; 0 = not known.
  virtual std::uint64_t training_rays() const = 0;

  /// Density of starts, 1/mm^2 on the surface; 0 off it. Starts that have no area (single points, lines) are
  /// not in it. Throws InputError when no start has an area (rays on one point or line).
  virtual double pdf_area(const Vec3& point_mm) const = 0;
  /// Density of directions at a start, 1/sr. Exists for every model.
  virtual double pdf_solid_angle(const Vec3& point_mm, const Direction& direction) const = 0;
  /// Density of rays, 1/(mm^2 sr) projected: pdf_area * pdf_solid_angle / |cosine to the surface's normal|;
  /// infinite at grazing directions that the model emits. Throws as pdf_area.
  virtual double pdf_etendue(const Ray& ray) const = 0;

  /// What its file holds.
  [[nodiscard]] virtual NflFile to_nfl() const = 0;
};

/// Reads a model file of any version and method. Throws InputError, one line that names the file, the place
/// and what is wrong, on anything that is not a whole, undamaged model.
[[nodiscard]] std::unique_ptr<SourceModel> load_source_model(const std::filesystem::path& path);

/// Writes `model`; returns the bytes of the file.
std::uint64_t save_source_model(const std::filesystem::path& path, const SourceModel& model);

/// The bytes of that file.
[[nodiscard]] std::string source_model_bytes(const SourceModel& model);
/// The model of such bytes; `name` is for messages. Throws as `load_source_model`.
[[nodiscard]] std::unique_ptr<SourceModel> source_model_from_bytes(std::string_view bytes,
                                                                   const std::string& name);

/// Étendue in mm2 sr that holds the brightest share of the flux, for each of `shares` in [0, 1], from `rays`
/// of the model's rays and their density; all 0 where the rays fill no étendue. Noise: about 1 / sqrt(rays)
/// of each value. Cost: `pdf_etendue` of each ray. Throws InputError for a share outside [0, 1].
[[nodiscard]] std::vector<double> etendue_mm2sr(const SourceModel& model, std::span<const double> shares,
                                                std::uint64_t rays = 16'384, std::uint64_t seed = 1);

/// Does the file begin as a model file does? False for files that are missing or too short; reads 8 bytes.
[[nodiscard]] bool is_source_model(const std::filesystem::path& path);

/// The adaptive trees of docs/theory/source-model.md, or Mas-Martin-Patow clusters
/// (docs/theory/clusters.md).
enum class CompressMethod { adaptive, clusters };
/// "adaptive" or "clusters".
std::string_view to_string(CompressMethod method);
/// The method of such a name. Throws UsageError on anything else.
CompressMethod compress_method(std::string_view name);

/// How a model is made.
struct CompressOptions {
  /// How the density is modelled.
  CompressMethod method = CompressMethod::adaptive;
  /// The model file has at most so many bytes. Absent: as many as the rays justify.
  std::optional<std::uint64_t> max_bytes;
  /// Total flux of the model, in the unit of the rays; > 0. Absent: what the rays' header states.
  std::optional<double> flux;
  /// Of the random choices; the same seed gives the same model.
  std::uint64_t seed = 1;
  /// Of files with more rays the adaptive method holds so many in memory (>= 1), 68 bytes each, and lays the
  /// model's pieces out by these. How much light each piece has, all rays say: files are read once more.
  std::uint64_t max_rays_in_memory = 20'000'000;
};

/// Makes a model of rays in memory. The same rays, options and seed give the same model for any number of
/// threads. Throws InputError without rays, without flux, or if `max_bytes` is too little for any model (2000
/// always do). Cost: about 1 us a ray and core; memory: 40 bytes a ray (clusters 70) beside the rays.
[[nodiscard]] std::unique_ptr<SourceModel> compress(const RaySet& rays, const CompressOptions& options = {},
                                                    Progress& progress = no_progress());

/// A model of ray files.
struct CompressedFiles {
  /// The model; never null.
  std::unique_ptr<SourceModel> model;
  /// Rays in the files.
  std::uint64_t rays = 0;
  /// What was odd in the files but could be read, each with its place.
  std::vector<std::string> warnings;
  /// What was done that options do not say: rays of a large file that were left out.
  std::vector<std::string> notes;
};

/// Makes a model of ray files; several are superposed, and their fluxes add. The adaptive method uses at most
/// 20 M rays, spread evenly over the files, which are read block by block and may be larger than memory;
/// clusters hold all rays (28 bytes each). Throws as above, and what `open_ray_file` throws; UsageError
/// without files.
[[nodiscard]] CompressedFiles compress(const std::vector<std::filesystem::path>& files,
                                       const CompressOptions& options = {},
                                       Progress& progress = no_progress());

/// How rays are drawn into a file.
struct SampleOptions {
  /// Of the random numbers.
  std::uint64_t seed = 1;
  /// Independent or evenly spread rays.
  SequenceKind sequence = SequenceKind::random;
  /// Of the file, as `ray_formats` names them; empty: what its ending says.
  std::string format = {};
  /// What the file says that its rays were sampled from.
  std::string origin = {};
};

/// Draws `rays` rays from a model into a file: weights that sum to its flux, wavelengths and spectra where it
/// has them. The same bits for any number of threads. Returns what the format could not hold, one sentence
/// each. Throws UsageError as `ray_format_for`, InputError for no rays or a file that cannot be written;
/// Interrupted leaves no file.
std::vector<std::string> sample(const SourceModel& model, std::uint64_t rays,
                                const std::filesystem::path& file, const SampleOptions& options = {},
                                Progress& progress = no_progress());

/// The same into memory, of any source: rays 0 .. n - 1 of the stream that `sequence` fixes, with the
/// source's own weights (mean 1).
[[nodiscard]] RayBlock sample(const RaySource& source, std::size_t rays, const Sequence& sequence);

}  // namespace lucerna
#pragma GCC visibility pop
