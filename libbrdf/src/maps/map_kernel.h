#pragma once
// How BrdfMaps fills a map: a quadtree of samples, worked off in batches.

#include "maps/sample_batch.h"

#include <brdf/measured_brdf.h>

#include <wavelet/tree/map_set.h>

#include <cstdint>
#include <vector>

namespace haarlight::brdf {

/// The cell of reflection angles and rolls that one map covers, radians.
struct ReflectionCell {
  double theta_begin, theta_end;
  double phi_begin, phi_end;
};

/// Averages f_r over a map's pixels. A square of the domain takes 2 × 2 samples; a sample that is
/// wider than the table's bins allow there is replaced by those of its quarter, and so on. Every
/// sample has its own normal from the cell: quarters of the cell's range of θ_r go to the four
/// samples of a square, sixteenths to those of four squares (a radical inverse of the path down the
/// tree), and φ follows θ_r as in a Hammersley set.
class MapKernel {
public:
  /// @param supersample samples along a pixel's side at least
  /// @param cosine      whether to include max(0, n·ω)
  MapKernel(const MeasuredBrdf& brdf, const ReflectionCell& cell, int supersample, bool cosine);

  wavelet::Map make(int size) const;

private:
  static constexpr int normal_count = 256;

  /// A square waiting for its samples.
  struct Square {
    float u, v, side;    ///< corner and size
    float offset;        ///< place in the cell, in [0, 1); its samples get (order + offset) / 4
    float weight;        ///< of each of its samples in the pixel's average
    std::uint32_t pixel; ///< y · size + x
    std::uint32_t order; ///< which quarter of the cell goes to which sample
  };
  struct Job;

  void push_tile(Job& job, int tile_x, int tile_y) const;
  bool below_horizon(float u, float v, float side) const;
  void take_samples(Job& job) const;
  void settle_samples(Job& job) const;
  static void split(Job& job, const Square& parent, int sample);

  const MeasuredBrdf& m_brdf;
  int m_supersample;
  bool m_cosine;
  float m_cell_radius; ///< angle from the middle normal to the farthest
  Vec3 m_middle;
  float m_normals[3][normal_count]; ///< by offset within the cell of θ_r
};

} // namespace haarlight::brdf
