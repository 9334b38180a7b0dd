#pragma once
// A light probe: radiance by world direction, from a picture and its mapping.
//
// Only the area that the mapping covers is used. In round maps a pixel belongs to the probe if its
// centre lies in the disk r ≤ 1; the slivers of the disk in pixels whose centre lies outside show
// the nearest pixel that belongs. Captions and frames in the corners contribute nothing.

#include <probe/mapping.h>
#include <wavelet/base/image.h>

#include <span>
#include <string>
#include <vector>

namespace haarlight::probe {

/// Nearest: the pixel a direction falls in, so that radiance is piecewise constant and integral()
/// is exact for it. Bilinear: interpolated between pixel centres, across seams and poles too.
enum class Lookup { Nearest, Bilinear };

class Probe {
public:
  /// @param image finite, not negative (as read_image leaves it)
  /// @param path  names the picture in errors
  /// @throws Error(Input) if a mapping other than latlong meets a picture that is not square
  Probe(const Image& image, Mapping mapping, Lookup lookup = Lookup::Nearest,
        const std::string& path = {});

  Mapping mapping() const { return m_mapping; }
  Lookup lookup() const { return m_lookup; }
  int width() const { return m_width; }
  int height() const { return m_height; }
  const std::string& path() const { return m_path; }

  /// Radiance from a direction, in the picture's own unit.
  /// @param w unit vector in world axes
  Rgb radiance(const Vec3& w) const;

  /// The same for many directions at once, whose pixels are then fetched side by side.
  void radiance(std::span<const Vec3> directions, std::span<Rgb> out) const;

  /// Radiance of one pixel, −1 ≤ x ≤ width and −1 ≤ y ≤ height: one step beyond an edge gives the
  /// neighbour across the seam. Black well outside a round map.
  Rgb pixel(int x, int y) const { return Eigen::Map<const Rgb>(m_rgb.data() + offset(x, y)); }

  /// Whether a pixel lies in the picture and its centre in the map.
  bool owns(int x, int y) const {
    return x >= 0 && y >= 0 && x < m_width && y < m_height && in_map(m_mapping, centre(x, y));
  }

  /// Mean luminance over a pixel as radiance() returns it, 0 ≤ x < width and 0 ≤ y < height: its
  /// own, or with Bilinear that of the interpolation. Positive wherever radiance is.
  double mean_luminance(int x, int y) const;

  /// Direction of a pixel's centre.
  Vec3 direction(int x, int y) const { return image_to_direction(m_mapping, centre(x, y)); }

  /// Solid angle of the part of a pixel that belongs to the map, steradian; they add up to 4π.
  double pixel_solid_angle(int x, int y) const;

  /// ∫ L dω over the sphere, by quadrature over the pixels with their solid angles (Nearest
  /// look-up).
  Rgb integral() const;

private:
  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(m_width + 2) +
                static_cast<std::size_t>(x + 1));
  }
  Vec2 centre(int x, int y) const {
    return {(static_cast<float>(x) + 0.5F) / static_cast<float>(m_width),
            (static_cast<float>(y) + 0.5F) / static_cast<float>(m_height)};
  }
  void set(int x, int y, const Rgb& value) { Eigen::Map<Rgb>(m_rgb.data() + offset(x, y)) = value; }
  void fill_border();
  void fill_seam(int x, int y);
  void mask_outside();
  Rgb looked_up(const Vec2& uv) const;
  Rgb interpolated(const Vec2& uv) const;

  Mapping m_mapping;
  Lookup m_lookup;
  int m_width;
  int m_height;
  std::string m_path;
  std::vector<float> m_rgb; ///< with a border of one pixel
};

} // namespace haarlight::probe
