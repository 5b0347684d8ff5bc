// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/thinned_ray_set.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <string_view>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/message_bytes.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/data/merge_ray_sets.h"
#include "lucerna/rayset/data/ray_wavelengths.h"
#include "lucerna/rayset/data/subset.h"
#include "lucerna/rayset/files/named_warnings.h"

namespace lucerna {

namespace {

/// All columns of a block, in order.
template <class Block, class Use>
void for_each_column(Block& rays, const Use& use) {
  for (auto* column : {&rays.x_mm, &rays.y_mm, &rays.z_mm, &rays.kx, &rays.ky, &rays.kz, &rays.weight})
    use(*column);
  for (auto& column : rays.extra) use(column);
}

/// What is left of the extra columns.
enum class Columns { all, none, wavelengths };

/// Leaves that of `block`, whose first ray has the number `first` in its file.
void keep(Columns columns, const RayWavelengths& wavelengths, std::uint64_t first, RayBlock& block) {
  if (columns == Columns::all) return;
  std::vector<float> nm;
  for (std::size_t i = 0; columns == Columns::wavelengths && i < block.size(); ++i)
    nm.push_back(wavelengths.of(block, i, first + i));
  block.extra.clear();
  if (columns == Columns::wavelengths) block.extra.push_back(std::move(nm));
}

/// The same of a header.
void keep(Columns columns, RaySetHeader& header) {
  if (columns == Columns::all) return;
  header.columns.clear();
  if (columns == Columns::none) return;
  header.columns = {{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
  header.spectra.clear();
  header.wavelength_nm.reset();
}

bool have_one_colour(const RaySetHeader& a, const RaySetHeader& b) {
  return a.spectra == b.spectra && a.wavelength_nm == b.wavelength_nm;
}

/// A file of which some rays are wanted.
struct ThinnedFile {
  std::unique_ptr<RayReader> reader;
  RaySubset subset;
  RayWavelengths wavelengths;

  /// Those of the chosen rays that have the numbers `own`.
  RayBlock read(ItemRange own, Columns columns, Progress& progress) const {
    const std::uint64_t first = subset.begin(own.first), last = subset.begin(own.last);
    RayBlock rays, block;
    rays.extra.resize(reader->header().columns.size());
    keep(columns, wavelengths, 0, rays);
    rays.reserve(own.size());
    reader->skip(first);
    for (std::uint64_t at = first; at < last;) {
      const std::uint64_t some = std::min<std::uint64_t>(kStreamBlock, last - at);
      const std::size_t n = reader->read(block, static_cast<std::size_t>(some));
      if (n == 0) break;
      keep(columns, wavelengths, at, block);
      subset.select(block, at, rays);
      progress.step("read rays", (at += n) - first, last - first);
    }
    return rays;
  }
};

/// Opens the files and says how many rays of each are wanted.
std::vector<ThinnedFile> opened(const std::vector<std::filesystem::path>& files, const ThinOptions& options,
                                std::uint64_t& all_rays) {
  std::vector<std::unique_ptr<RayReader>> readers;
  for (const std::filesystem::path& file : files) {
    readers.push_back(open_ray_file(file));
    all_rays += readers.back()->ray_count();
  }
  const double share = static_cast<double>(options.max_rays) / static_cast<double>(all_rays);
  std::vector<ThinnedFile> all;
  for (auto& reader : readers) {
    const std::uint64_t count = reader->ray_count(), one = count > 0 ? 1 : 0;
    // A file without a ray would lose its flux.
    const std::uint64_t wanted =
        all_rays <= options.max_rays
            ? count
            : std::max(one, static_cast<std::uint64_t>(share * static_cast<double>(count)));
    const RaySetHeader& header = reader->header();
    RayWavelengths wavelengths(header, header.flux_unit);
    all.push_back({std::move(reader), RaySubset(count, wanted, options.seed), std::move(wavelengths)});
  }
  return all;
}

/// What is kept of all files alike.
Columns columns_of(const std::vector<ThinnedFile>& files, const std::vector<std::filesystem::path>& names,
                   const ThinOptions& options, std::vector<std::string>& warnings) {
  if (!options.only_wavelengths) return Columns::all;
  const RaySetHeader& first = files.front().reader->header();
  bool differ = false;
  std::vector<std::string> unknown;
  for (std::size_t k = 0; k < files.size(); ++k) {
    const RaySetHeader& header = files[k].reader->header();
    differ = differ || files[k].wavelengths.differ_by_ray() || !have_one_colour(header, first);
    if (!files[k].wavelengths.are_known()) unknown.push_back(names[k].string());
  }
  if (!differ) return Columns::none;
  if (unknown.empty()) return Columns::wavelengths;
  warnings.push_back(
      fmt::format("{}: nothing is known of its colour, so all colours are dropped", unknown.front()));
  return Columns::none;
}

/// The rays of all parts, in order, on all peers.
RayBlock joined(Peers* peers, RayBlock own) {
  if (peers == nullptr) return own;
  const auto n = static_cast<std::size_t>(peers->size());
  std::vector<RayBlock> parts(n);
  const std::size_t columns = own.extra.size();
  parts[static_cast<std::size_t>(peers->rank())] = std::move(own);
  share_items(
      peers, n, StateKey().add(std::uint64_t{columns}).value(),
      [&](std::size_t r, std::string& bytes) {
        for_each_column(parts[r], [&](const std::vector<float>& column) { append(bytes, column); });
      },
      [&](std::size_t r, std::string_view& bytes) {
        parts[r].extra.resize(columns);
        for_each_column(parts[r], [&](std::vector<float>& column) { take(bytes, column); });
      });
  for (std::size_t r = 1; r < n; ++r) {
    parts.front().append(parts[r]);
    parts[r] = {};
  }
  return std::move(parts.front());
}

/// Calls `use` with all rays of a file, block by block; their columns as they are in the file.
void for_each_block(RayReader& reader, const std::function<void(RayBlock&, std::uint64_t first)>& use) {
  RayBlock block;
  std::uint64_t at = 0;
  while (const std::size_t n = reader.read(block, kStreamBlock)) {
    use(block, at);
    at += n;
  }
}

double sum_of_weights(const std::filesystem::path& file) {
  double sum = 0.0;
  const auto reader = open_ray_file(file);
  for_each_block(*reader, [&](const RayBlock& block, std::uint64_t) {
    sum = std::accumulate(block.weight.begin(), block.weight.end(), sum);
  });
  return sum;
}

/// What `read` returns; an InputError of one peer is thrown by all.
template <class Read>
auto together(Peers* peers, const Read& read) {
  if (peers == nullptr) return read();
  decltype(read()) result;
  std::string error;
  try {
    result = read();
  } catch (const InputError& e) {
    error = e.what();
  }
  for (const std::string& text : peers->gather(error)) {
    if (!text.empty()) throw InputError(text, ErrorCause::damaged);
  }
  return result;
}

}  // namespace

ThinnedRaySet thinned_ray_set(const std::vector<std::filesystem::path>& files, const ThinOptions& options,
                              Progress& progress) {
  ThinnedRaySet out;
  const auto readers = together(options.peers, [&] { return opened(files, options, out.of); });
  const Columns columns = columns_of(readers, files, options, out.warnings);
  for (std::size_t k = 0; k < files.size(); ++k) {
    const ThinnedFile& file = readers[k];
    const ItemRange own = own_items(options.peers, file.subset.count());
    RayBlock rays = together(options.peers, [&] { return file.read(own, columns, progress); });
    RaySet set{file.reader->header(), joined(options.peers, std::move(rays))};
    keep(columns, set.header);
    add_named_warnings(files[k], file.reader->warnings(), out.warnings);
    if (files.size() == 1) {
      out.set = std::move(set);
    } else {
      merge_ray_sets(out.set, std::move(set), files[k].string());
    }
  }
  return out;
}

void for_each_ray_block(const std::vector<std::filesystem::path>& files,
                        const std::function<void(const RayBlock&)>& use, Progress& progress) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  std::uint64_t all = 0, done = 0;
  std::vector<std::string> told;
  const ThinOptions options{.only_wavelengths = true};
  const auto opened_files = opened(files, options, all);
  const Columns columns = columns_of(opened_files, files, options, told);
  RayBlock some;
  const auto pass_on = [&] {
    if (!some.empty()) use(some);
    some.resize(0, some.extra.size());
    progress.step("count rays", done, all);
  };
  for (std::size_t k = 0; k < files.size(); ++k) {
    const RaySetHeader& header = opened_files[k].reader->header();
    const double sum = files.size() > 1 ? sum_of_weights(files[k]) : 0.0;
    const auto factor = static_cast<float>(sum > 0.0 ? *header.flux() / sum : 1.0);
    for_each_block(*opened_files[k].reader, [&](RayBlock& block, std::uint64_t first) {
      keep(columns, opened_files[k].wavelengths, first, block);
      for (float& weight : block.weight) weight *= factor;
      some.append(block);
      done += block.size();
      if (some.size() >= kBlock) pass_on();
    });
  }
  pass_on();
}

}  // namespace lucerna
