#pragma once
// Differences of two maps, or of two sets of maps.
//
// A is the reference, B is compared with it. Integrals ∫∫ run over the unit square, so that they
// are averages over pixels; colours count by luminance, |c|² = Σ w_i c_i², as thresholding counts
// them. Everything is in the unit of the maps' pixels: a BRDF set whose pixels hold f_r·cos is
// compared with the cosine.

#include <wavelet/file/tree_set.h>
#include <wavelet/square/symmetry.h>
#include <wavelet/tree/map_set.h>

#include <memory>
#include <vector>

namespace haarlight::wavelet {

/// Sums of squared L2-normalised Haar coefficients.
struct LevelDifference {
  double difference = 0; ///< of B − A
  double reference = 0;  ///< of A

  double l2() const;
  double relative_l2() const; ///< 0 of equal maps, infinite where A holds nothing
};

/// Of two maps. Of two sets: averages over the maps; maxima over the maps for maxima.
struct Difference {
  double squared_error = 0; ///< ∫∫ |B − A|²
  double energy = 0;        ///< ∫∫ |A|²
  double largest_error = 0; ///< largest |B − A| of any channel
  double peak = 0;          ///< largest |A| of any channel
  LevelDifference mean;     ///< of the scaling function: the maps' averages
  std::vector<LevelDifference>
      levels; ///< by level of the wavelets, 0 first. By Parseval's identity
              ///< they and the mean add up to squared_error and energy

  double l2() const; ///< root mean square
  double relative_l2() const;
  double relative_linf() const;
  /// 20 log₁₀(peak / l2), dB; infinite for equal maps.
  double psnr() const;
};

struct MapDifference {
  Difference difference;
  int x = 0; ///< the pixel of the largest error
  int y = 0;
  double mean_a = 0; ///< luminance, average over the map
  double mean_b = 0;
};

/// @param a,b of equal size
MapDifference compare_maps(const Map& a, const Map& b);

struct SetDifference {
  Difference difference;
  int maps = 0;

  MapPlace largest; ///< the map with the largest error of a channel …
  int x = 0;        ///< … and its pixel
  int y = 0;

  MapPlace worst; ///< the map with the largest l2
  Difference worst_difference;

  double mean_error = 0;       ///< of the sum of all maps' averages (luminance), relative, signed
  double worst_mean_error = 0; ///< of one map's average, absolute, relative to the larger of A's
                               ///< own and a tenth of A's over all maps
  MapPlace worst_mean;
};

/// Compares map by map, a few at a time and from several threads; the result does not depend on
/// their number.
/// @param a,b sets of equal size, columns and rows
/// @throws exceptions of the sources
SetDifference compare_sets(const MapSource& a, const MapSource& b, const Progress& progress = {});

// Views that make two sets comparable: sets of maps in another form. A view makes a map when asked
// for it and shares ownership of its source.

using SharedMaps = std::shared_ptr<const MapSource>;

/// A stored map seen through a symmetry: pixel p is the stored pixel at symmetry.to_stored(p).
Map turned(const Map& stored, const SquareSymmetry& symmetry);

/// The maps of a .haar file, reconstructed at their finest level.
SharedMaps tree_maps(std::shared_ptr<const TreeSet> trees);

/// Averages down to `size` pixels a side. @param size a power of two, at most the set's
SharedMaps shrunk(SharedMaps maps, int size);

/// All rolls of a folded set, one row each, in the order of <wavelet/square/symmetry.h>.
SharedMaps unfolded(SharedMaps maps);

/// One map, as a set of its own. Its info keeps the kind; rolls and fold are those of one map.
SharedMaps one_map(SharedMaps maps, int column, int row);

/// Luminance in all three channels.
SharedMaps in_luminance(SharedMaps maps);

} // namespace haarlight::wavelet
