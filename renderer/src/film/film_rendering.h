#pragma once
// What all ways to render share: one ray through each pixel's centre, tiles, threads, and passes
// until the time is up. What is done where a ray hits is a PixelShader's business.

#include "film/pixel_sums.h"

#include <renderer/film/render.h>

#include <functional>
#include <memory>

namespace haarlight::renderer {

/// A run of samples for every pixel.
struct Pass {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// What shading costs besides time; grows until taken.
struct ShadingCost {
  double prepare_seconds = 0;
  std::uint64_t points = 0;
  std::uint64_t leaves = 0;
};

/// What a pixel sees.
struct PixelHit {
  Hit hit; ///< its normal on the viewer's side
  Vec3 wo; ///< unit direction to the viewer, world
  std::uint32_t pixel = 0;
};

/// Shades pixels, one after another; each thread has its own.
class PixelShader {
public:
  virtual ~PixelShader() = default;

  /// Forgets the pixels before: what comes depends on the pixels to come alone.
  virtual void reset() = 0;

  /// Adds a pass's samples of reflected light to the pixel's sums.
  virtual void shade(const PixelHit& seen, const Pass& pass, PixelSums& sums) = 0;

  /// The cost since last asked.
  ShadingCost take_cost() { return std::exchange(m_cost, {}); }

protected:
  ShadingCost m_cost;
};

/// Makes a thread's own; called from any thread.
using MakeShader = std::function<std::unique_ptr<PixelShader>()>;

/// Renders the film. Its bytes depend on scene, options and shader alone, unless there is a time
/// limit.
RenderResult render_film(const LoadedScene& scene, const RenderOptions& options,
                         const MakeShader& make, int width, int height,
                         const RenderProgress& progress);

} // namespace haarlight::renderer
