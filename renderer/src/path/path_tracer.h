#pragma once
// Paths from the second vertex on.

#include "path_vertex.h"

#include <renderer/path.h>

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
      : m_scene(scene), m_options(options), m_vertex(scene, emitters) {}

  /// The light that comes back along a departure from the first vertex, times its weight.
  /// @param points  of the pixel
  /// @param path    the path's index among the pixel's
  /// @param lights  whether the distant light seen from the first vertex counts, by balance
  Rgb follow(const Hit& first, Departure departure, const PathPoints& points, std::uint32_t path,
             bool lights);

private:
  bool survives(int vertex, const VertexPoints& points, Rgb& throughput) const;

  const LoadedScene& m_scene;
  PathOptions m_options;
  PathVertex m_vertex;
};

} // namespace haarlight::renderer
