#include <wavelet/base/cpu_clones.h>
#include <wavelet/tree/descent.h>

#include <array>

namespace haarlight::wavelet {
namespace {

/// So many descents alternate.
constexpr std::size_t width = 32;

/// Takes a step with every one of `count` densities that is not at its tree's end, again and again
/// until all are. @param choose (i, weights) → quadrant
template <class Choose>
void walk_all(TreeDensity* densities, Descent* descents, std::size_t count, Choose choose) {
  std::array<std::uint8_t, width> active;
  std::size_t left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    active[left] = static_cast<std::uint8_t>(i);
    left += densities[i].node != no_node ? 1 : 0;
  }
  while (left > 0) {
    std::size_t next = 0;
    for (std::size_t k = 0; k < left; ++k) {
      const std::size_t i = active[k];
      detail::step_down(densities[i], descents[i], [&](Float4 w) { return choose(i, w); });
      densities[i].tree->prefetch(densities[i].node);
      active[next] = static_cast<std::uint8_t>(i);
      next += densities[i].node != no_node ? 1 : 0;
    }
    left = next;
  }
}

} // namespace

HAARLIGHT_CPU_CLONES void descend_tree(std::span<TreeDensity> densities,
                                       std::span<Descent> descents) {
  for (std::size_t begin = 0; begin < descents.size(); begin += width) {
    Descent* d = descents.data() + begin;
    TreeDensity* density = densities.data() + begin;
    const std::size_t count = std::min(width, descents.size() - begin);
    walk_all(density, d, count, [&](std::size_t i, Float4 w) { return steer(d[i], w); });
    for (std::size_t i = 0; i < count; ++i)
      detail::spread(density[i], d[i]);
  }
}

HAARLIGHT_CPU_CLONES void follow_tree(std::span<TreeDensity> densities,
                                      std::span<const Vec2> points, std::span<Descent> descents) {
  for (std::size_t begin = 0; begin < descents.size(); begin += width) {
    Descent* d = descents.data() + begin;
    TreeDensity* density = densities.data() + begin;
    const Vec2* p = points.data() + begin;
    const std::size_t count = std::min(width, descents.size() - begin);
    walk_all(density, d, count,
             [&](std::size_t i, Float4 /*w*/) { return steer_to(d[i], p[i].x(), p[i].y()); });
    for (std::size_t i = 0; i < count; ++i)
      detail::follow_spread(density[i], p[i].x(), p[i].y(), d[i]);
  }
}

} // namespace haarlight::wavelet
