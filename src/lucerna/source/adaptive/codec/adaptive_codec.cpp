// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/source/adaptive/codec/tree_codec.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/file/nfl.h"

namespace lucerna {

namespace {

constexpr NflTag kLayerTag{'L', 'A', 'Y', 'R'}, kTreeTag{'T', 'R', 'E', 'E'},
    kSpectrumTag{'S', 'P', 'E', 'C'}, kWaveTag{'W', 'A', 'V', 'E'};
constexpr std::uint64_t kMaxLayers = 64, kMaxTrees = 64, kMaxSpectra = 4096, kMaxText = 4096;
constexpr std::size_t kMaxNodes = std::size_t{1} << 24;
constexpr double kLargestLength = 1e9, kMaxRays = 1e18;

void put_text(NflWriter& w, const std::string& text) {
  const std::size_t n = std::min<std::size_t>(text.size(), kMaxText);
  w.varint(n);
  for (std::size_t i = 0; i < n; ++i) w.u8(static_cast<std::uint8_t>(text[i]));
}

std::string get_text(NflReader& r) {
  const std::uint64_t n = r.varint();
  r.expect(n <= kMaxText && n <= r.left(), "a text that does not fit");
  std::string text;
  for (std::uint64_t i = 0; i < n; ++i) text.push_back(static_cast<char>(r.u8()));
  return text;
}

void put_vector(NflWriter& w, const Vec3& v) {
  for (const double x : {v.x, v.y, v.z}) w.f64(x);
}

double get_length(NflReader& r) {
  const double x = r.f64();
  r.expect(std::abs(x) <= kLargestLength, "a length beyond 1e9 mm");
  return x;
}

Vec3 get_vector(NflReader& r) {
  const double x = get_length(r), y = get_length(r);
  return {x, y, get_length(r)};
}

void put_frame(NflWriter& w, const Frame& f) {
  for (const Vec3& v : {f.ex(), f.ey(), f.ez(), f.origin_mm()}) put_vector(w, v);
}

Frame get_frame(NflReader& r) {
  const Vec3 x = get_vector(r), y = get_vector(r), z = get_vector(r);
  constexpr double kTolerance = 1e-9;
  for (const Vec3& v : {x, y, z})
    r.expect(std::abs(dot(v, v) - 1.0) < kTolerance, "an axis that is not unit");
  r.expect(length(cross(x, y) - z) < kTolerance, "axes that are not square");
  return {x, y, z, get_vector(r)};
}

void put_surface(NflWriter& w, const BoundingSurface& s) {
  w.u8(static_cast<std::uint8_t>(s.kind));
  put_frame(w, s.world_from_surface);
  w.f64(s.radius_mm);
  put_vector(w, s.half_size_mm);
}

BoundingSurface get_surface(NflReader& r) {
  const std::uint8_t kind = r.u8();
  r.expect(kind <= static_cast<std::uint8_t>(SurfaceKind::box), "an unknown surface");
  BoundingSurface s;
  s.kind = static_cast<SurfaceKind>(kind);
  s.world_from_surface = get_frame(r);
  s.radius_mm = get_length(r);
  s.half_size_mm = get_vector(r);
  const Vec3& h = s.half_size_mm;
  const bool round = s.kind == SurfaceKind::sphere || s.kind == SurfaceKind::cylinder;
  r.expect(s.radius_mm >= 0.0 && h.x >= 0.0 && h.y >= 0.0 && h.z >= 0.0, "a surface of negative size");
  r.expect(!round || s.radius_mm > 0.0, "a round surface without a radius");
  r.expect(s.kind != SurfaceKind::box || (h.x > 0.0 && h.y > 0.0 && h.z > 0.0), "a box without volume");
  return s;
}

/// Version 2 of the format: set in the byte of the kind where a dome follows. Programs that know version 1
/// only see an unknown kind and refuse the file.
constexpr std::uint8_t kHasDome = 0x80;
constexpr double kLargestIndex = 10.0;

void put_support(NflWriter& w, const Support& s) {
  w.u8(static_cast<std::uint8_t>(static_cast<std::uint8_t>(s.kind) | (s.dome.exists() ? kHasDome : 0)));
  w.u8(static_cast<std::uint8_t>(s.map));
  put_frame(w, s.world_from_support);
  w.f64(s.radius_mm);
  put_vector(w, s.half_size_mm);
  w.f64(s.twist_per_mm);
  if (!s.dome.exists()) return;
  put_vector(w, s.dome.centre_mm);
  w.f64(s.dome.radius_mm);
  w.f64(s.dome.index);
}

Support get_support(NflReader& r) {
  const std::uint8_t first = r.u8(), map = r.u8(), kind = first & static_cast<std::uint8_t>(~kHasDome);
  r.expect(kind < kSupportKinds && map <= 1, "an unknown support");
  Support s;
  s.kind = static_cast<SupportKind>(kind);
  s.map = static_cast<PolarMap>(map);
  s.world_from_support = get_frame(r);
  s.radius_mm = get_length(r);
  s.half_size_mm = get_vector(r);
  s.twist_per_mm = get_length(r);
  const Vec3& h = s.half_size_mm;
  const bool round = s.kind == SupportKind::sphere || s.kind == SupportKind::cylinder;
  r.expect(!round || s.radius_mm > 0.0, "a round support without a radius");
  r.expect(h.x >= 0.0 && h.y >= 0.0 && h.z >= 0.0, "a support of negative size");
  if ((first & kHasDome) == 0) return s;
  s.dome.centre_mm = get_vector(r);
  s.dome.radius_mm = get_length(r);
  s.dome.index = r.f64();
  r.expect(s.dome.radius_mm > 0.0, "a dome without a radius");
  r.expect(s.dome.index >= 1.0 && s.dome.index <= kLargestIndex, "an index of refraction outside 1 to 10");
  return s;
}

void put_chart(NflWriter& w, const AdaptiveChart& c) {
  w.u8(static_cast<std::uint8_t>(c.chart));
  w.f64(c.share);
  for (std::size_t d = 0; d < 4; ++d) w.f64(c.box.low[d]), w.f64(c.box.high[d]);
  w.u8(static_cast<std::uint8_t>(c.trees.size()));
  for (const DensityTree& tree : c.trees) w.f64(tree.rays);
}

AdaptiveChart get_chart(NflReader& r, const Support& support) {
  AdaptiveChart c;
  c.chart = r.u8();
  r.expect(c.chart < support.charts(), "a chart that the support does not have");
  c.share = r.f64();
  r.expect(c.share >= 0.0 && c.share <= 1.0, "a share outside [0, 1]");
  for (std::size_t d = 0; d < 4; ++d) {
    c.box.low[d] = get_length(r);
    c.box.high[d] = get_length(r);
    r.expect(c.box.low[d] <= c.box.high[d], "a box turned inside out");
  }
  const std::uint64_t trees = r.u8();
  r.expect(trees >= 1 && trees <= kMaxTrees, "a number of trees out of range");
  c.trees.resize(trees);
  for (DensityTree& tree : c.trees) {
    tree.rays = r.f64();
    r.expect(tree.rays >= 0.0 && tree.rays <= kMaxRays, "a number of rays out of range");
  }
  return c;
}

void put_spectra(NflFile& file, const std::vector<SpectralTable>& spectra) {
  if (spectra.empty()) return;
  NflWriter w;
  w.varint(spectra.size());
  for (const SpectralTable& table : spectra) {
    w.varint(table.wavelength_nm.size());
    for (std::size_t i = 0; i < table.wavelength_nm.size(); ++i) {
      w.u32(std::bit_cast<std::uint32_t>(table.wavelength_nm[i]));
      w.u32(std::bit_cast<std::uint32_t>(table.relative_power[i]));
    }
  }
  file.add(kSpectrumTag, w.take());
}

bool has_section(const NflFile& file, const NflTag& tag) {
  return std::any_of(file.sections.begin(), file.sections.end(),
                     [&](const NflFile::Section& s) { return s.tag == tag; });
}

std::vector<SpectralTable> get_spectra(const NflFile& file, std::string_view name) {
  std::vector<SpectralTable> spectra;
  if (!has_section(file, kSpectrumTag)) return spectra;
  NflReader r(file, kSpectrumTag, name);
  const std::uint64_t tables = r.varint();
  r.expect(tables <= kMaxSpectra, "too many spectra");
  for (std::uint64_t t = 0; t < tables; ++t) {
    const std::uint64_t n = r.varint();
    r.expect(n <= r.left() / 8, "a spectrum that does not fit");
    SpectralTable& table = spectra.emplace_back();
    for (std::uint64_t i = 0; i < n; ++i) {
      table.wavelength_nm.push_back(std::bit_cast<float>(r.u32()));
      table.relative_power.push_back(std::bit_cast<float>(r.u32()));
      const bool finite =
          std::isfinite(table.wavelength_nm.back()) && std::isfinite(table.relative_power.back());
      r.expect(finite, "a spectrum that is not finite");
    }
  }
  r.finish();
  return spectra;
}

void put_wavelengths(NflFile& file, const AdaptiveData& data) {
  if (data.wavelengths.empty()) return;
  NflWriter w;
  w.varint(data.wavelengths.size());
  for (const WavelengthTable& table : data.wavelengths) {
    w.varint(table.nm.size());
    for (std::size_t i = 0; i < table.nm.size(); ++i) {
      w.u32(std::bit_cast<std::uint32_t>(table.share[i]));
      w.u32(std::bit_cast<std::uint32_t>(table.nm[i]));
    }
  }
  for (const AdaptiveLayer& layer : data.layers) w.varint(layer.band);
  file.add(kWaveTag, w.take());
}

void get_wavelengths(const NflFile& file, std::string_view name, AdaptiveData& data) {
  if (!has_section(file, kWaveTag)) return;
  NflReader r(file, kWaveTag, name);
  const std::uint64_t tables = r.varint();
  r.expect(tables >= 1 && tables <= kMaxLayers, "a number of wavelength tables out of range");
  for (std::uint64_t t = 0; t < tables; ++t) {
    const std::uint64_t n = r.varint();
    r.expect(n >= 2 && n <= r.left() / 8, "a table of wavelengths that does not fit");
    WavelengthTable& table = data.wavelengths.emplace_back();
    for (std::uint64_t i = 0; i < n; ++i) {
      table.share.push_back(std::bit_cast<float>(r.u32()));
      table.nm.push_back(std::bit_cast<float>(r.u32()));
      r.expect(std::isfinite(table.nm.back()) && table.nm.back() > 0.0f, "a wavelength that is not > 0");
      const bool ascends = i == 0 ? table.share[0] == 0.0f
                                  : table.share[i] >= table.share[i - 1] && table.nm[i] >= table.nm[i - 1];
      r.expect(ascends, "a table of wavelengths that does not ascend from share 0");
    }
    r.expect(table.share.back() == 1.0f, "a table of wavelengths that does not end at share 1");
  }
  for (AdaptiveLayer& layer : data.layers) {
    const std::uint64_t band = r.varint();
    r.expect(band < tables, "a band that has no table");
    layer.band = static_cast<std::uint32_t>(band);
  }
  r.finish();
}

void decode_trees(const NflFile& file, std::string_view name, AdaptiveData& data) {
  std::string_view bytes;
  for (const auto& section : file.sections) {
    if (section.tag == kTreeTag) bytes = section.bytes;
  }
  RangeDecoder coder(bytes);
  TreeCodec codec;
  std::size_t left = kMaxNodes;
  for (AdaptiveLayer& layer : data.layers) {
    for (AdaptiveChart& chart : layer.charts) {
      std::uint64_t number = 0;
      for (DensityTree& tree : chart.trees) {
        if (!codec.decode(coder, tree.rays, number++, left, tree.nodes)) {
          throw_input_error(name, "section 'TREE'", "the trees do not decode: bytes end, or make no tree");
        }
        left -= tree.nodes.size();
      }
    }
  }
}

AdaptiveLayer get_layer(NflReader& r) {
  AdaptiveLayer layer;
  layer.support = get_support(r);
  layer.share = r.f64();
  r.expect(layer.share >= 0.0 && layer.share <= 1.0, "a share outside [0, 1]");
  layer.why = get_text(r);
  const std::uint8_t charts = r.u8();
  r.expect(charts >= 1 && charts <= layer.support.charts(), "a number of charts out of range");
  for (std::uint8_t i = 0; i < charts; ++i) layer.charts.push_back(get_chart(r, layer.support));
  return layer;
}

/// Sum of the charts' shares of the flux; a model needs it to be 1.
double total_share(const AdaptiveData& data) {
  double total = 0.0;
  for (const AdaptiveLayer& layer : data.layers) {
    for (const AdaptiveChart& chart : layer.charts) total += layer.share * chart.share;
  }
  return total;
}

}  // namespace

NflFile encode_adaptive(const AdaptiveData& data) {
  NflFile file;
  file.method = kAdaptiveMethod;
  file.flux = data.flux;
  file.flux_unit = data.flux_unit;
  file.training_rays = data.training_rays;
  NflWriter w;
  put_surface(w, data.surface);
  w.varint(data.layers.size());
  RangeEncoder coder;
  TreeCodec codec;
  for (const AdaptiveLayer& layer : data.layers) {
    put_support(w, layer.support);
    w.f64(layer.share);
    put_text(w, layer.why);
    w.u8(static_cast<std::uint8_t>(layer.charts.size()));
    for (const AdaptiveChart& chart : layer.charts) {
      put_chart(w, chart);
      std::uint64_t number = 0;
      for (const DensityTree& tree : chart.trees) codec.encode(coder, tree, number++);
    }
  }
  const bool domes = std::any_of(data.layers.begin(), data.layers.end(),
                                 [](const AdaptiveLayer& layer) { return layer.support.dome.exists(); });
  if (domes) file.version = 2;
  file.add(kLayerTag, w.take());
  file.add(kTreeTag, coder.finish());
  put_spectra(file, data.spectra);
  put_wavelengths(file, data);
  return file;
}

AdaptiveData decode_adaptive(const NflFile& file, std::string_view name) {
  AdaptiveData data;
  data.flux = file.flux;
  data.flux_unit = file.flux_unit;
  data.training_rays = file.training_rays;
  NflReader r(file, kLayerTag, name);
  data.surface = get_surface(r);
  const std::uint64_t layers = r.varint();
  r.expect(layers >= 1 && layers <= kMaxLayers, "a number of layers out of range");
  for (std::uint64_t i = 0; i < layers; ++i) data.layers.push_back(get_layer(r));
  r.expect(std::abs(total_share(data) - 1.0) < 1e-9, "shares that do not sum to 1");
  r.finish();
  decode_trees(file, name, data);
  data.spectra = get_spectra(file, name);
  get_wavelengths(file, name, data);
  return data;
}

}  // namespace lucerna
