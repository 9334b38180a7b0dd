#include "path/path_tracer.h"

#include <algorithm>

namespace haarlight::renderer {
namespace {

constexpr int first_roulette = 3; ///< vertex
constexpr float most_survive = 0.95F;
constexpr std::uint32_t roulette_dimension = 8; ///< above those of PathVertex

} // namespace

Rgb PathTracer::follow(Hit at, BsdfSample bsdf_sample, const PathPoints& points,
                       std::uint32_t path) {
  Rgb sum = Rgb::Zero();
  Rgb throughput = bsdf_sample.weight;
  for (int vertex = 2; m_options.depth == 0 || vertex <= m_options.depth; ++vertex) {
    const VertexPoints source = points.at(vertex, path);
    m_vertex.set_hit(at, -bsdf_sample.direction);
    Rgb direct = Rgb::Zero();
    m_vertex.add_light(source, std::span(&direct, 1));
    m_vertex.add_emitters(source, std::span(&direct, 1));
    sum += throughput * direct;
    m_vertex.sample_bsdf(source, std::span(&bsdf_sample, 1));
    throughput *= bsdf_sample.weight;
    if (!(throughput > 0).any() || !survives(vertex, source, throughput))
      break;
    const PathStep found = m_vertex.look(bsdf_sample);
    sum += throughput * found.light;
    if (!found.hit)
      break;
    at = *found.hit;
  }
  return sum;
}

/// Russian roulette; what survives stands for the rest.
bool PathTracer::survives(int vertex, const VertexPoints& points, Rgb& throughput) const {
  if (vertex < first_roulette)
    return true;
  const float chance = std::min(most_survive, throughput.maxCoeff());
  Vec2 u;
  points.fill(roulette_dimension, 1, std::span(&u, 1));
  if (!(u.x() < chance))
    return false;
  throughput /= chance;
  return true;
}

} // namespace haarlight::renderer
