#pragma once
// A partition of a probe's picture that follows a reflectance: rectangles small where it varies and
// there is light, and the product of both over each.

#include "samplers/light_sums.h"

#include <renderer/material/material.h>

#include <span>
#include <vector>

namespace haarlight::renderer {

/// A probe as partitions see it; shared by threads.
struct LightPicture {
  probe::Mapping mapping;
  LightSums sums;

  explicit LightPicture(const probe::Probe& probe) : mapping(probe.mapping()), sums(probe) {}

  /// The pixel an image point lies in.
  std::pair<int, int> pixel(const Vec2& uv) const {
    return {
        std::min(static_cast<int>(uv.x() * static_cast<float>(sums.width())), sums.width() - 1),
        std::min(static_cast<int>(uv.y() * static_cast<float>(sums.height())), sums.height() - 1)};
  }
};

/// A quadtree of rectangles. Each guesses the mean of f_r cos (luminance) over itself from its
/// corners, its centre and the marks inside; the one whose values differ most, times
/// its light, is divided next. All densities are exactly those of the descent.
class LightPartition {
public:
  explicit LightPartition(const LightPicture& picture) : m_picture(picture) {}

  /// @param marks directions where the reflectance may rise where no corner sees it
  /// @param regions undivided rectangles at most, 4 or more
  void build(const ShadingPoint& point, const Material& material, std::span<const Vec3> marks,
             std::size_t regions);

  /// Warps a point of the unit square through the tree, then through the light of the region.
  /// @param density receives the place's density, sr⁻¹; 0 if it is no direction
  Vec2 sample(const Vec2& u, float& density) const;

  /// Density of sample() at an image point, sr⁻¹.
  float pdf(const Vec2& uv) const;

  std::size_t regions() const { return 1 + (m_nodes.size() - 1) / 4 * 3; }

private:
  static constexpr std::size_t batch = 8; ///< rectangles divided at a time
  static constexpr std::size_t points_per_split = 8;

  struct Values {
    float corner[4] = {}; ///< (x0, y0), (x1, y0), (x0, y1), (x1, y1)
    float centre = 0;
  };
  struct Node {
    PixelRange range;
    Values values;
    double light = 0;
    double product = 0;
    float mean = 0; ///< guess of f_r cos
    int child = -1; ///< first of four, in the order of the corners; −1 undivided
  };
  struct Entry {
    double error;
    int node;
    bool operator<(const Entry& other) const { return error < other.error; }
  };
  struct Mark {
    int x = 0; ///< pixel
    int y = 0;
    float value = 0;
  };

  void start();
  void evaluate_marks(std::span<const Vec3> marks);
  bool is_fine() const;
  void split_batch();
  void split(int node, std::span<const float> fresh);
  void request_split(const Node& node);
  void request(float x, float y);
  void request_centre(const PixelRange& range);
  void evaluate();
  int add(const PixelRange& range, const Values& values);
  double judge(Node& node) const;
  void sum_products();
  float density(const Node& leaf, std::uint64_t light, const Vec2& uv) const;

  const LightPicture& m_picture;
  const ShadingPoint* m_point = nullptr;
  const Material* m_material = nullptr;
  std::vector<Mark> m_marks;
  std::vector<Node> m_nodes;
  std::vector<Entry> m_queue; ///< a heap
  double m_error = 0;         ///< of all undivided rectangles
  double m_product = 0;       ///< guess of ∫ f_r L cos, in units of light
  double m_floor = 0;         ///< f_r cos that every rectangle has at least
  std::vector<int> m_batch;
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_values;
  std::vector<float> m_reflected;
};

} // namespace haarlight::renderer
