#include <probe/mapping.h>

#include "mapping/mapping_lanes.h"

namespace haarlight::probe {
namespace {

constexpr Mapping all_mappings[] = {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall,
                                    Mapping::Octahedral};

} // namespace

std::string mapping_name(Mapping mapping) {
  switch (mapping) {
  case Mapping::Angular:
    return "angular";
  case Mapping::LatLong:
    return "latlong";
  case Mapping::MirrorBall:
    return "mirrorball";
  case Mapping::Octahedral:
    return "octahedral";
  }
  std::abort();
}

std::optional<Mapping> parse_mapping(const std::string& name) {
  for (const Mapping mapping : all_mappings)
    if (mapping_name(mapping) == name)
      return mapping;
  return std::nullopt;
}

Vec3 image_to_direction(Mapping mapping, const Vec2& uv) {
  Vec3 w;
  with_mapping(mapping, [&](auto map) { map.direction(uv.x(), uv.y(), w.x(), w.y(), w.z()); });
  return w;
}

Vec2 direction_to_image(Mapping mapping, const Vec3& w) {
  Vec2 uv;
  with_mapping(mapping, [&](auto map) { map.image(w.x(), w.y(), w.z(), uv.x(), uv.y()); });
  return uv;
}

float solid_angle_density(Mapping mapping, const Vec2& uv) {
  return with_mapping(mapping, [&](auto map) { return map.density(uv.x(), uv.y()); });
}

} // namespace haarlight::probe
