#pragma once
// Sets of square maps, the currency between the tools: a table of N × N RGB maps over the sphere,
// indexed by a column and a row. A BRDF set's column is θ_r and its row the roll φ; an EM set's two
// indices are the cell of ω_r in an M × M grid on the square of <wavelet/square/sphere_map.h>.

#include <wavelet/base/geometry.h>
#include <wavelet/file/provenance.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::wavelet {

/// One N × N map, interleaved RGB, row 0 first; pixel (x, y) covers the square
/// [x/N, (x+1)/N] × [y/N, (y+1)/N] and holds its average.
struct Map {
  int size = 0; ///< a power of two
  std::vector<float> rgb;

  explicit Map(int pixels = 0)
      : size(pixels), rgb(3 * static_cast<std::size_t>(pixels) * static_cast<std::size_t>(pixels)) {
  }

  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
                static_cast<std::size_t>(x));
  }
  Rgb at(int x, int y) const { return Eigen::Map<const Rgb>(rgb.data() + offset(x, y)); }
  void set(int x, int y, const Rgb& value) { Eigen::Map<Rgb>(rgb.data() + offset(x, y)) = value; }
};

/// Average of a map's pixels, summed in double.
Eigen::Array3d map_mean(const Map& map);

/// A map's averages over squares of two by two pixels. @param map of two pixels a side or more
Map halved(const Map& map);

enum class SetKind : std::uint32_t {
  Generic = 0, ///< any functions on the square
  Brdf = 1,    ///< f_r(ω_o, ω)·max(0, n·ω) (or f_r alone) in the reflection frame, sr⁻¹
  Light = 2,   ///< radiance by direction, in the probe's own unit
  Transfer = 3 ///< by pixel of a film: the product of all factors but one
};

/// The part of a set's rows that is stored; the others are permutations of its pixels (the square's
/// symmetry D4).
enum class Fold : std::uint32_t {
  None = 0,
  Rotations = 1, ///< rolls φ ∈ [0, π/2): roll φ + π/2 is the map turned by 90°
  Mirrors = 2 ///< rolls φ ∈ [0, π/4]: roll π/2 − φ is the map mirrored in the diagonal u = v
};

/// Metadata of a set.
struct SetInfo {
  SetKind kind = SetKind::Generic;
  int size = 0;    ///< pixels along one side of a map, a power of two
  int columns = 1; ///< stored maps along the first index
  int rows = 1;    ///< stored maps along the second index
  int rolls = 1;   ///< BRDF sets: rolls over the full circle, of which `rows` are stored; else 1
  Fold fold = Fold::None;
  bool cosine = false;      ///< BRDF sets: pixels include max(0, n·ω)
  bool world_frame = false; ///< light sets: one map, local axes = world axes
  std::string frame;        ///< the frame convention in words
  std::string units;        ///< of a pixel
  Provenance provenance;

  int map_count() const { return columns * rows; }
};

/// The indices of a map in its set.
struct MapPlace {
  int column = 0;
  int row = 0;
};

/// Makes the maps of a set one by one. Implementations are safe to call from several threads.
class MapSource {
public:
  virtual ~MapSource() = default;
  virtual const SetInfo& info() const = 0;

  /// @param column 0 ≤ column < info().columns
  /// @param row    0 ≤ row < info().rows
  virtual Map make(int column, int row) const = 0;

  /// Integral of the same function over the sphere (dω), integrated from the source rather
  /// than from its map: the reference of conservation. Nothing if unknown.
  virtual std::optional<Rgb> integral(int /*column*/, int /*row*/) const { return std::nullopt; }
};

/// How well a set's maps keep the integrals of their source: relative errors of luminance.
struct Conservation {
  double mean_error = 0;    ///< signed, of the sums over all maps
  double largest_error = 0; ///< absolute, of the worst map, relative to the larger of its own
                            ///< integral and a tenth of the set's mean
  int worst_column = 0;
  int worst_row = 0;
};

/// Gathers map integrals as maps are made; add() is safe from several threads.
class ConservationMeter {
public:
  explicit ConservationMeter(const SetInfo& info);
  void add(int column, int row, const Map& map, const std::optional<Rgb>& truth);
  /// Nothing if no reference integral was known.
  std::optional<Conservation> result() const;

private:
  struct Pair {
    double map = 0;
    double truth = 0;
    bool known = false;
  };
  int m_columns;
  std::vector<Pair> m_pairs;
};

/// Called now and then with the maps done so far and their number in all.
using Progress = std::function<void(int done, int total)>;

} // namespace haarlight::wavelet
