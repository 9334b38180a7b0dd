#include "visibility/outline.h"

#include "shapes/shape_canonical.h"

namespace haarlight::renderer::detail {
namespace {

/// Whether a point sees the face of a box at the low or the high end of an axis.
bool sees_face(const Bounds& box, const Eigen::Vector3d& from, int axis, bool high) {
  return high ? from[axis] > box.high[axis] : from[axis] < box.low[axis];
}

/// An edge of a box in the direction of an axis, at either end of the two next axes.
struct Edge {
  int axis = 0;
  bool high1 = false;
  bool high2 = false;

  int axis1() const { return (axis + 1) % 3; }
  int axis2() const { return (axis + 2) % 3; }

  bool is_silhouette(const Bounds& box, const Eigen::Vector3d& from) const {
    return sees_face(box, from, axis1(), high1) != sees_face(box, from, axis2(), high2);
  }

  Eigen::Vector3d end(const Bounds& box, bool high) const {
    Eigen::Vector3d p;
    p[axis] = (high ? box.high : box.low)[axis];
    p[axis1()] = (high1 ? box.high : box.low)[axis1()];
    p[axis2()] = (high2 ? box.high : box.low)[axis2()];
    return p;
  }
};

} // namespace

Outline outline_of(const Solid& solid, const Eigen::Vector3d& origin,
                   const Eigen::Matrix3f& to_frame) {
  const Bounds box = canonical_bounds(solid);
  const Eigen::Vector3d from = solid.to_object.point(origin);
  const auto seen = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return solid.to_world.point(p) - origin;
  };
  const Eigen::Vector3d middle = seen((box.low + box.high) / 2);
  Outline outline;
  int count = 0;
  for (int i = 0; i < 12; ++i) {
    const Edge edge = {i / 4, i % 2 != 0, i / 2 % 2 != 0};
    if (!edge.is_silhouette(box, from))
      continue;
    const Eigen::Vector3d across = seen(edge.end(box, false)).cross(seen(edge.end(box, true)));
    const Vec3 normal = to_frame * across.normalized().cast<float>();
    for (int lane = count++; lane < 8; ++lane)
      outline.set(lane, across.dot(middle) < 0 ? Vec3(-normal) : normal);
  }
  return outline;
}

} // namespace haarlight::renderer::detail
