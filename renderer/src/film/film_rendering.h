#pragma once
// The framework of all integrators: one ray through each pixel's centre, tiles, threads, and passes
// up to the time limit. A PixelShader computes the light reflected at a hit.

#include "film/pixel_sums.h"

#include <renderer/film/render.h>

#include <functional>
#include <memory>

namespace haarlight::renderer {

/// A range of samples of every pixel.
struct Pass {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// Accumulated cost of shading.
struct ShadingCost {
  double prepare_seconds = 0;
  std::uint64_t points = 0;
  std::uint64_t leaves = 0;
};

/// The hit of a pixel's ray.
struct PixelHit {
  Hit hit; ///< its normal on the viewer's side
  Vec3 wo; ///< unit direction to the viewer, world
  std::uint32_t pixel = 0;
};

/// Shades pixels; one per thread.
class PixelShader {
public:
  virtual ~PixelShader() = default;

  /// Clears cached state.
  virtual void reset() = 0;

  /// Adds a pass's samples of reflected light to the pixel's sums.
  virtual void shade(const PixelHit& seen, const Pass& pass, PixelSums& sums) = 0;

  /// The cost since the last call.
  ShadingCost take_cost() { return std::exchange(m_cost, {}); }

protected:
  ShadingCost m_cost;
};

/// Creates a thread's shader; called from any thread.
using MakeShader = std::function<std::unique_ptr<PixelShader>()>;

/// Renders the film. Its bytes depend only on scene, options and shader, unless there is a time
/// limit.
RenderResult render_film(const LoadedScene& scene, const RenderOptions& options,
                         const MakeShader& make, int width, int height,
                         const RenderProgress& progress);

} // namespace haarlight::renderer
