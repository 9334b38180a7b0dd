#pragma once
// Importance sampling of a probe: a pixel is drawn with probability proportional to its
// luminance times its solid angle, a point in it uniformly in image coordinates.

#include <probe/probe.h>

#include <cstdint>
#include <span>
#include <vector>

namespace haarlight::probe {

struct PixelRectangle;

/// A direction towards the light and the density it was drawn with.
struct LightSample {
  Vec3 direction; ///< unit vector in world axes
  float pdf = 0;  ///< sr⁻¹
};

/// Inverts the marginal cdf of the rows, then the conditional one within the row, so that
/// stratified and low-discrepancy points stay so. Within a pixel the density is p_pixel / (area in
/// (u, v) · dω/(du dv)). Pixels that the rim of a round map runs through are sampled in their inner
/// part only: u uniform over the columns that meet the disk, v uniform over the chord there.
///
/// For a probe with bilinear look-up a pixel's weight is the mean of the interpolated luminance
/// over it (its neighbours count too), so that the density is positive wherever the radiance is.
///
/// Of a black probe all directions are equally likely.
class LightDistribution {
public:
  /// Keeps no reference to the probe.
  explicit LightDistribution(const Probe& probe);

  /// @param u uniform in [0, 1)²; its y picks the row, its x the column
  LightSample sample(const Vec2& u) const;

  /// The same for many points at once, whose steps wait for memory side by side.
  void sample(std::span<const Vec2> points, std::span<LightSample> out) const;

  /// A place in a pixel: fractions in [0, 1) of the way across and down.
  struct PixelPoint {
    int x = 0;
    int y = 0;
    Vec2 fraction = Vec2::Zero();
  };

  /// Probability with which sample() draws a pixel; they add up to 1.
  double probability(int x, int y) const;

  /// sample() within given pixels, for pixels drawn by other means.
  void sample_in(std::span<const PixelPoint> points, std::span<LightSample> out) const;

  int width() const { return m_width; }
  int height() const { return m_height; }

  /// Density of sample() in solid angle at a unit direction, sr⁻¹.
  float pdf(const Vec3& w) const;

private:
  struct Step {
    int index = 0;
    std::uint32_t width = 0; ///< of the cdf's step, in units of 1/one
    float fraction = 0;      ///< of the way through it
  };
  struct Place {
    float u = 0;
    float v = 0;
    float area = 0; ///< in (u, v), that the pixel's probability is spread over
  };
  /// Cumulative distributions are integers up to `one`, so that the density is exactly that of the
  /// sampling, however small a pixel's probability.
  static constexpr std::uint32_t one = std::uint32_t{1} << 31U;
  /// Parts of the rows' guide for each step. The columns' have a quarter for each, so as to stay in
  /// the cache, whose misses cost more than steps.
  static constexpr int row_parts = 8;

  static void accumulate(const std::vector<double>& weights, std::uint32_t* cdf);
  static void make_guide(const std::uint32_t* cdf, int parts, std::uint32_t* guide);
  static Step find(const std::uint32_t* cdf, const std::uint32_t* guide, int parts, float u);
  Step find_row(float u) const;
  Step find_column(const Step& row, float u) const;
  Step step_of_row(int y) const;
  Step step_of_column(int x, int y) const;
  void finish(std::span<const Step> rows, std::span<const Step> columns,
              std::span<LightSample> out) const;
  Place place_in_pixel(const Step& column, const Step& row) const;
  static Place place_at_rim(const PixelRectangle& pixel, float s, float t);
  float pixel_area(int x, int y, float u) const;
  static float density(std::uint32_t row_width, std::uint32_t column_width, float solid_angle);

  Mapping m_mapping;
  int m_width;
  int m_height;
  std::vector<std::uint32_t> m_rows;      ///< cdf, height + 1
  std::vector<std::uint32_t> m_row_guide; ///< where equal parts of the cdf begin
  std::vector<std::uint32_t> m_columns;   ///< cdfs, width + 1 for each row
  int m_column_parts;
  std::vector<std::uint32_t> m_column_guide; ///< the same for each row
};

} // namespace haarlight::probe
