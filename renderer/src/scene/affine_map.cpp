#include <renderer/scene/affine_map.h>

#include <wavelet/base/elementary.h>

#include <cassert>
#include <cmath>

namespace haarlight::renderer {
namespace {

constexpr double largest_coefficient = 1e18;

bool moderate(const AffineMap& transform) {
  const auto small = [](double x) { return std::abs(x) <= largest_coefficient; }; // false for NaN
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      if (!small(transform.linear(row, column)))
        return false;
  return small(transform.offset.x()) && small(transform.offset.y()) && small(transform.offset.z());
}

} // namespace

bool AffineMap::usable() const { return moderate(*this) && moderate(inverse()); }

AffineMap AffineMap::inverse() const {
  AffineMap result;
  result.linear = linear.inverse();
  result.offset = -(result.linear * offset);
  return result;
}

AffineMap translation(const Eigen::Vector3d& by) { return {Eigen::Matrix3d::Identity(), by}; }

AffineMap scaling(const Eigen::Vector3d& factors) {
  return {Eigen::Matrix3d(factors.asDiagonal()), Eigen::Vector3d::Zero()};
}

AffineMap rotation(const Eigen::Vector3d& axis, double degrees) {
  assert(axis.squaredNorm() > 0);
  const Eigen::Vector3d a = axis.stableNormalized();
  const SineCosine turn = sine_cosine_degrees(degrees);
  Eigen::Matrix3d cross;
  cross << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  const Eigen::Matrix3d along = a * a.transpose();
  AffineMap result;
  result.linear =
      turn.cosine * Eigen::Matrix3d::Identity() + turn.sine * cross + (1 - turn.cosine) * along;
  return result;
}

AffineMap euler_rotation(const Eigen::Vector3d& degrees) {
  return rotation(Eigen::Vector3d::UnitX(), degrees.x())
      .then(rotation(Eigen::Vector3d::UnitY(), degrees.y()))
      .then(rotation(Eigen::Vector3d::UnitZ(), degrees.z()));
}

} // namespace haarlight::renderer
