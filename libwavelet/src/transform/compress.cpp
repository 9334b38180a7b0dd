#include <wavelet/transform/compress.h>

#include "transform/coefficient_walk.h"
#include "tree/map_batches.h"
#include "tree/tree_builder.h"

#include <wavelet/file/packed_set.h>
#include <wavelet/file/tree_set.h>
#include <wavelet/transform/quantize.h>
#include <wavelet/transform/transform.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace haarlight::wavelet {
namespace {

/// The C locale's shortest decimal that tells doubles of an option apart.
std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

void describe(const CompressOptions& options, Provenance& provenance) {
  provenance.set("criterion", criterion_name(options.threshold.criterion));
  if (options.threshold.keep)
    provenance.set("keep", std::to_string(*options.threshold.keep));
  else
    provenance.set("tolerance", number_text(options.threshold.tolerance));
  if (options.quantize)
    provenance.set("quantize", "yes");
}

void measure_pixels(const Map& original, const Map& kept, int channels, CompressReport& report) {
  const double area = 1.0 / (static_cast<double>(original.size) * original.size);
  for (std::size_t i = 0; i < original.rgb.size(); i += 3) {
    Rgb a = Eigen::Map<const Rgb>(original.rgb.data() + i);
    const Rgb b = Eigen::Map<const Rgb>(kept.rgb.data() + i);
    if (channels == 1)
      a = Rgb::Constant(luminance(a));
    const Rgb error = b - a;
    report.energy += area * weighted_square(a.data());
    report.squared_error += area * weighted_square(error.data());
    report.peak = std::max(report.peak, static_cast<double>(a.abs().maxCoeff()));
    report.largest_error =
        std::max(report.largest_error, static_cast<double>(error.abs().maxCoeff()));
    report.mass += area * static_cast<double>(std::abs(luminance(a)));
    report.negative_mass += area * std::max(0.0, -static_cast<double>(luminance(b)));
  }
}

Map grey(Map map) {
  for (std::size_t i = 0; i < map.rgb.size(); i += 3) {
    Eigen::Map<Rgb> pixel(map.rgb.data() + i);
    pixel = luminance(pixel);
  }
  return map;
}

/// The maps of one batch, compressed in parallel and stored in order.
struct Slot {
  Tree tree;
  CompressReport report;
};

std::unique_ptr<TreeSink> sink_for(const CompressOptions& options, const SetInfo& info,
                                   OutputFile& file) {
  const int channels = options.luminance ? 1 : 3;
  if (options.packed)
    return std::make_unique<PackedSetWriter>(file, info, channels, options.coefficients);
  return std::make_unique<TreeSetWriter>(file, info, channels, options.coefficients);
}

} // namespace

double CompressReport::relative_l2_error() const {
  return energy > 0 ? std::sqrt(squared_error / energy) : 0;
}

double CompressReport::relative_linf_error() const { return peak > 0 ? largest_error / peak : 0; }

void CompressReport::add(const CompressReport& other) {
  total_coefficients += other.total_coefficients;
  kept_coefficients += other.kept_coefficients;
  nodes += other.nodes;
  energy += other.energy;
  squared_error += other.squared_error;
  peak = std::max(peak, other.peak);
  largest_error = std::max(largest_error, other.largest_error);
  mass += other.mass;
  negative_mass += other.negative_mass;
}

Tree compress_map(const Map& map, const CompressOptions& options, CompressReport& report) {
  const int channels = options.luminance ? 1 : 3;
  Map transformed = options.luminance ? grey(map) : map;
  haar_forward(transformed.rgb.data(), map.size, 3);
  report = {};
  report.total_coefficients =
      static_cast<std::uint64_t>(map.size) * static_cast<std::uint64_t>(map.size) - 1;
  Quantized quantized;
  if (options.quantize)
    quantized = apply_quantization(transformed, options.threshold);
  else
    quantized.coefficients = apply_threshold(transformed, options.threshold).coefficients;
  report.kept_coefficients = quantized.coefficients;
  Tree tree = build_tree(transformed, channels, options.coefficients, quantized.scale);
  report.nodes = tree.links.size();
  measure_pixels(map, tree.view().reconstruct(tree.levels), channels, report);
  return tree;
}

CompressReport compress_set(const MapSource& source, const CompressOptions& options,
                            OutputFile& file, const Progress& progress) {
  SetInfo info = source.info();
  describe(options, info.provenance);
  const std::unique_ptr<TreeSink> sink = sink_for(options, info, file);
  ConservationMeter meter(info);
  CompressReport total;
  for_each_map<Slot>(
      info, 4, progress,
      [&](const MapPlace& place, Slot& slot) {
        const Map map = source.make(place.column, place.row);
        meter.add(place.column, place.row, map, source.integral(place.column, place.row));
        slot.tree = compress_map(map, options, slot.report);
      },
      [&](Slot& slot) {
        sink->add(std::move(slot.tree));
        total.add(slot.report);
      });
  sink->finish();
  total.bytes = file.position();
  total.conservation = meter.result();
  return total;
}

} // namespace haarlight::wavelet
