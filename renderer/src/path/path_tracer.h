#pragma once
// Paths from the second vertex on.

#include "path/path_vertex.h"

#include <renderer/path/path.h>

namespace haarlight::renderer {

/// The random points of a pixel's paths.
struct PathPoints {
  Points kind = Points::Sobol;
  std::uint32_t key = 0; ///< of the pixel and the seed

  /// Of a vertex, 1 being the first, from path `first` on.
  VertexPoints at(int vertex, std::uint32_t first) const {
    return {kind, hash_words(key, 0x70617468U + static_cast<std::uint32_t>(vertex)), first};
  }
};

/// One thread's.
class PathTracer {
public:
  PathTracer(const LoadedScene& scene, const Emitters& emitters, const PathOptions& options)
      : m_options(options), m_vertex(scene, emitters) {}

  /// The light that comes back from a path's second vertex, times its weight so far.
  /// @param at        the second vertex
  /// @param bsdf_sample that led there
  /// @param points    of the pixel
  /// @param path      the path's index among the pixel's
  Rgb follow(Hit at, BsdfSample bsdf_sample, const PathPoints& points, std::uint32_t path);

private:
  bool survives(int vertex, const VertexPoints& points, Rgb& throughput) const;

  PathOptions m_options;
  PathVertex m_vertex;
};

} // namespace haarlight::renderer
