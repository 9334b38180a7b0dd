#include <wavelet/transform/compress.h>

#include "tree/map_batches.h"
#include "tree/tree_writer.h"

#include <wavelet/file/tree_set.h>
#include <wavelet/transform/threshold.h>
#include <wavelet/transform/transform.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <vector>

namespace haarlight::wavelet {
namespace {

/// The C locale's shortest decimal that distinguishes the doubles of an option.
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

/// Builds the tree of a transformed, thresholded map.
class TreeBuilder {
public:
  TreeBuilder(const Map& map, int channels, CoefficientType type) : m_map(map) {
    m_tree.levels = std::countr_zero(static_cast<unsigned>(map.size));
    m_tree.channels = channels;
    m_tree.type = type;
    const Rgb mean = map.at(0, 0);
    m_tree.mean = channels == 3 ? mean : Rgb::Constant(luminance(mean));
  }

  /// @param scale of the coefficients, if they fit it; 0 = a power of two that fits them
  Tree build(float scale) {
    choose_scale(scale);
    mark_squares();
    TreeWriter writer(m_tree);
    std::vector<Square> squares; // breadth first
    if (m_tree.levels > 0 && is_present({}))
      squares.emplace_back();
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const Square s = squares[i];
      const unsigned mask = child_mask(s);
      writer.add(mask, details(s));
      for (unsigned q = 0; q < 4; ++q)
        if ((mask >> q & 1U) != 0)
          squares.push_back(s.quadrant(q));
    }
    writer.finish();
    return std::move(m_tree);
  }

private:
  Float4 coefficient(const Square& s, int m) const {
    const float* c = m_map.rgb.data() + 3 * coefficient_index(m_map.size, s, m);
    return Float4{c[0], c[1], c[2], 0};
  }

  Details details(const Square& s) const {
    return {coefficient(s, 1), coefficient(s, 2), coefficient(s, 3)};
  }

  bool has_detail(const Square& s) const {
    for (int m = 1; m <= 3; ++m) {
      const Float4 c = coefficient(s, m);
      if (is_stored(c[0]) || is_stored(c[1]) || is_stored(c[2]))
        return true;
    }
    return false;
  }

  /// False for differences that become zeros in halves.
  bool is_stored(float difference) const {
    return difference != 0 && (m_tree.type == CoefficientType::Float ||
                               std::abs(difference) / m_tree.scale > smallest_stored_half);
  }

  /// Marks the squares that have a wavelet in or under them, finest level first.
  void mark_squares() {
    m_present.resize(static_cast<std::size_t>(m_tree.levels));
    for (std::int32_t l = m_tree.levels - 1; l >= 0; --l) {
      const std::uint32_t side = 1U << l;
      auto& marks = m_present[static_cast<std::size_t>(l)];
      marks.reserve(static_cast<std::size_t>(side) * side);
      for (Square s = {l, 0, 0}; s.row < side; ++s.row)
        for (s.column = 0; s.column < side; ++s.column)
          marks.push_back(has_detail(s) || child_mask(s) != 0 ? 1 : 0);
    }
  }

  bool is_present(const Square& s) const {
    const std::size_t place = (static_cast<std::size_t>(s.row) << s.level) + s.column;
    return m_present[static_cast<std::size_t>(s.level)][place] != 0;
  }

  unsigned child_mask(const Square& s) const {
    unsigned mask = 0;
    for (unsigned q = 0; q < 4 && s.level + 1 < m_tree.levels; ++q)
      mask |= is_present(s.quadrant(q)) ? 1U << q : 0U;
    return mask;
  }

  void choose_scale(float scale) {
    float largest = 0;
    for (std::size_t i = 3; i < m_map.rgb.size(); ++i)
      largest = std::max(largest, std::abs(m_map.rgb[i]));
    const bool fits = scale > 0 && largest / scale <= largest_stored_half;
    m_tree.scale = fits ? scale : coefficient_scale(m_tree.type, largest);
  }

  const Map& m_map;
  Tree m_tree;
  std::vector<std::vector<std::uint8_t>> m_present; ///< by level, row and column
};

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
  Tree tree = TreeBuilder(transformed, channels, options.coefficients).build(quantized.scale);
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
