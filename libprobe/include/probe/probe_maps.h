#pragma once
// Sets of square maps made from a probe: one in the world's frame, or a table of rotated ones.
//
// Squares are those of <wavelet/square/sphere_map.h>. Each pixel is the average of the probe's
// radiance over its square, and no light is missed, however small: see world_map().

#include <probe/probe.h>

#include <wavelet/tree/map_set.h>

#include <vector>

namespace haarlight::probe {

struct MapOptions {
  int size = 0;         ///< pixels along a side, a power of two ≥ 4; 0 = default_map_size()
  int orientations = 1; ///< M: 1 = the one world-frame map, else M × M cells of ω_r
  int supersample = 4;  ///< s, 1 to 64: at least s² samples for each pixel
};

/// The frame of cell (i, j) of M × M: n = ω_r = square_to_sphere((i + ½)/M, (j + ½)/M), and t and b
/// those of frame_about(ω_r) in <wavelet/base/geometry.h>. A map's pixel at local ω shows the
/// radiance from t ω_x + b ω_y + ω_r ω_z. For M = 1 maps are in world axes instead.
Frame light_frame(int i, int j, int orientations);

/// The frame of a cell carried along the great circle to another axis: the least rotation that
/// takes frame.n to `w`. Maps are averaged over their cell in these frames.
Frame carried_frame(const Frame& frame, const Vec3& w);

/// For a world-frame map: a power of two, at least 3.2 × the probe's width so that few pixels lie
/// across the edges of the probe's, within 512 and 2048; 128 for the maps of a table.
int default_map_size(const Probe& probe, int orientations);

/// The world-frame map: pixel (x, y) is the average over its square of the probe's radiance
/// (nearest look-up), local axes = world axes; never brighter than the probe. Small probes, those
/// whose pixels are large in the map, and all pixels far brighter than those around them are added
/// by the exact area that they cover of each map pixel. The rest is sampled, more densely where the
/// probe's pixels are small.
/// @param size        pixels along a side, a power of two ≥ 4
/// @param supersample 1 to 64: at least supersample² samples for each pixel
wavelet::Map world_map(const Probe& probe, int size, int supersample);

/// A pixel of a picture and its radiance.
struct SourcePixel {
  int x = 0;
  int y = 0;
  Rgb radiance = Rgb::Zero();
};

/// A world map prepared for being rotated. Pixels far brighter than those around them are added by
/// the exact area that they cover of each pixel of the rotated map; the others are sampled.
struct RotatableMap {
  int size = 0;
  float unit = 1;          ///< of the radiances below, so that their sums stay finite
  std::vector<float> rgbw; ///< with a border one pixel wide: radiance and 1, or 0 for peaks
  std::vector<SourcePixel> peaks;
};

/// Prepares a world map for rotate_map().
/// @param largest_size the map is averaged down to at most so many pixels along a side
RotatableMap make_rotatable(const wavelet::Map& world, int largest_size = 1 << 30);

/// The map in another frame: the pixel at direction ω is the average over its square of the
/// source map (nearest look-up) at frame.to_outer(ω), and never outside the range of its
/// values. Peaks are added by area. The rest is sampled 2 × 2 times for each pixel of the source,
/// and from 8 × 8 times (128² pixels and more) to 32 × 32 times (32² and fewer) for each of the
/// map.
/// @param size pixels along a side, a power of two ≥ 4
wavelet::Map rotate_map(const RotatableMap& level, const Frame& frame, int size);

/// The maps of a probe. make() is the world map, or the map of one cell of ω_r, averaged over the
/// cell. The latter are made from the world map averaged down to about their resolution, so that
/// memory stays at that and one map for each thread.
class ProbeMaps : public wavelet::MapSource {
public:
  /// @param source origin of the probe, the first entries of the set's provenance
  /// @throws Error(Input) if the probe's integral is beyond float
  ProbeMaps(const Probe& probe, const MapOptions& options, const Provenance& source = {});

  const wavelet::SetInfo& info() const override { return m_info; }
  wavelet::Map make(int column, int row) const override;
  std::optional<Rgb> integral(int column, int row) const override;

private:
  void describe(const Provenance& source, Mapping mapping);

  MapOptions m_options;
  Rgb m_integral;
  wavelet::SetInfo m_info;
  wavelet::Map m_world;  ///< for one orientation
  RotatableMap m_source; ///< for more
};

} // namespace haarlight::probe
