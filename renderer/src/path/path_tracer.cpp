#include "path_tracer.h"

#include <algorithm>

namespace haarlight::renderer {
namespace {

constexpr int first_roulette = 3; ///< vertex
constexpr float most_survive = 0.95F;
constexpr std::uint32_t roulette_dimension = 8; ///< above those of PathVertex

} // namespace

Rgb PathTracer::follow(const Hit& first, Departure departure, const PathPoints& points,
                       std::uint32_t path, bool lights) {
  Rgb sum = Rgb::Zero();
  Rgb throughput = departure.weight;
  Hit from = first;
  for (int vertex = 2; (throughput > 0).any(); ++vertex) {
    Hit hit;
    if (!m_scene.shapes().intersect(leave(from, departure.direction), hit)) {
      if (lights)
        sum += throughput * m_vertex.escaped(departure);
      break;
    }
    sum += throughput * m_vertex.met(from, departure, hit);
    if (m_options.depth > 0 && vertex > m_options.depth)
      break;
    if (hit.normal.dot(departure.direction) > 0)
      hit.normal = -hit.normal;
    m_vertex.arrive(hit, -departure.direction);
    const VertexPoints source = points.at(vertex, path);
    Rgb direct = Rgb::Zero();
    m_vertex.add_light(source, std::span(&direct, 1));
    m_vertex.add_emitters(source, std::span(&direct, 1));
    sum += throughput * direct;
    m_vertex.depart(source, std::span(&departure, 1));
    throughput *= departure.weight;
    if (!survives(vertex, source, throughput))
      break;
    from = hit;
    lights = true;
  }
  return sum;
}

/// Russian roulette; what survives stands for the rest.
bool PathTracer::survives(int vertex, const VertexPoints& points, Rgb& throughput) const {
  if (vertex < first_roulette)
    return true;
  const float chance = std::min(most_survive, throughput.maxCoeff());
  Vec2 u;
  points.fill(roulette_dimension, std::span(&u, 1));
  if (!(u.x() < chance))
    return false;
  throughput /= chance;
  return true;
}

} // namespace haarlight::renderer
