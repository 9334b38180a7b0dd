#pragma once
// Maps to sparse trees: transform, threshold, store.

#include <wavelet/file/output_file.h>
#include <wavelet/transform/threshold.h>
#include <wavelet/tree/map_set.h>
#include <wavelet/tree/tree.h>

#include <cstdint>
#include <optional>

namespace haarlight::wavelet {

struct CompressOptions {
  ThresholdOptions threshold;
  CoefficientType coefficients = CoefficientType::Half;
  bool luminance = false; ///< store one channel, the luminance, in place of RGB
  bool quantize = false;  ///< round the coefficients kept, see <wavelet/transform/threshold.h>
  bool packed = false;    ///< compress_set(): write the packed form, see <wavelet/file/tree_set.h>
};

/// Statistics of the compression of a map or, summed, of a set.
struct CompressReport {
  std::uint64_t total_coefficients = 0; ///< 4^levels − 1 per map; an RGB triple counts as one
  std::uint64_t kept_coefficients = 0;
  std::uint64_t nodes = 0;  ///< squares stored
  std::uint64_t bytes = 0;  ///< of the file
  double energy = 0;        ///< Σ over maps of ∫∫ F², colours weighted by luminance
  double squared_error = 0; ///< the same of F − F'
  double peak = 0;          ///< largest |value| of any channel
  double largest_error = 0; ///< largest |F − F'| of any channel
  double mass = 0;          ///< Σ over maps of ∫∫ |F|, luminance
  double negative_mass = 0; ///< Σ over maps of ∫∫ max(0, −F'), luminance
  std::optional<Conservation>
      conservation; ///< of the maps, before compression, where the source knows

  double relative_l2_error() const;
  double relative_linf_error() const;
  void add(const CompressReport& other);
};

/// One map as a tree. @param report receives the map's figures, bytes and conservation apart
Tree compress_map(const Map& map, const CompressOptions& options, CompressReport& report);

/// Compresses every map of a set, a few at a time and from several threads, into a .haar file. The
/// file's bytes depend on the maps, the SetInfo and the options alone. The caller commits `file`.
/// @throws Error(Output) if writing fails, and exceptions of the source
CompressReport compress_set(const MapSource& source, const CompressOptions& options,
                            OutputFile& file, const Progress& progress = {});

} // namespace haarlight::wavelet
