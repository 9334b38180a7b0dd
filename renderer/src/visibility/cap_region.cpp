#include "visibility/cap_region.h"

#include <cmath>

namespace haarlight::renderer::detail {

using wavelet::RegionPart;
using wavelet::Square;

Cap Cap::around_ball(const Eigen::Vector3d& centre, double radius) {
  const double distance = centre.norm();
  Cap cap;
  if (distance <= radius) {
    cap.cosine = -1;
    cap.sine = 0;
    cap.chord_squared = 4;
    return cap;
  }
  const double sine = radius / distance;
  const double cosine = std::sqrt((1 - sine) * (1 + sine));
  cap.axis = (centre / distance).cast<float>();
  cap.cosine = static_cast<float>(cosine);
  cap.sine = static_cast<float>(sine);
  cap.chord_squared = static_cast<float>(2 * sine * sine / (1 + cosine));
  return cap;
}

RegionPart CapRegion::classify(const Square& square) const {
  const RegionPart part = m_cap.classify(wavelet::square_cap(square));
  if (part == RegionPart::Partial)
    return part;
  return (part == RegionPart::Inside) != m_reverse ? RegionPart::Inside : RegionPart::Outside;
}

float CapRegion::coverage(const Square& square) const {
  const Vec3& a = m_cap.axis;
  const float share = wavelet::positive_fraction_of(square, [&](Float4 x, Float4 y, Float4 z) {
    const Float4 dx = x - a.x();
    const Float4 dy = y - a.y();
    const Float4 dz = z - a.z();
    return m_cap.chord_squared - (dx * dx + dy * dy + dz * dz);
  });
  return m_reverse ? 1 - share : share;
}

} // namespace haarlight::renderer::detail
