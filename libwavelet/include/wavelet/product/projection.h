#pragma once
// Products of trees and of a rotated reflectance, as sparse trees within a tolerance.
//
// multiply() keeps all coefficients of its factors, and a reflectance has detail everywhere. The
// projector refines squares while they leave too much of the product's variation, averages them
// upwards and prunes within the tolerance. It makes the transfer of a shading point: the product of
// the fixed factors of its integral, all in one frame.

#include <wavelet/product/adaptive_product.h>
#include <wavelet/tree/tree.h>

#include <memory>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// The variance of luminance within the square of each node of a tree, by Parseval.
std::vector<float> variances_within(const TreeView& tree);

/// A factor that is a tree. Its arrays must outlive the projection.
struct ProjectionFactor {
  TreeView tree;
  /// variances_within(tree); nullptr for a visibility, whose values are 0 or 1 except in the
  /// finest squares: a square of mean m then has the variance m (1 − m).
  const float* variances = nullptr;
};

struct ProjectionOptions {
  int levels = 7; ///< of the resulting trees: squares of side 2^-levels are not split, 1 to 13
  /// Bound of sqrt(∫ (T' − T)²/T' / ∫ T) for the tree T' of a product T: the relative root mean
  /// square error of ∫ T·F where F is one small light whose position is distributed as T'. Squares
  /// darker than 3 % of the mean count as 3 %. Estimated, without the variation within the finest
  /// squares.
  double tolerance = 0.1;
  CoefficientType coefficients = CoefficientType::Half;
};

struct ProjectionReport {
  std::size_t squares = 0; ///< evaluated
  double dropped = 0;      ///< the square of the error that the tolerance bounds
  double unresolved = 0;   ///< the square of the error due to variation within the finest squares
};

/// Projects one product after another; memory is reused.
class ProductProjector {
public:
  explicit ProductProjector(const ProjectionOptions& options);
  ~ProductProjector();
  ProductProjector(ProductProjector&&) noexcept;
  ProductProjector& operator=(ProductProjector&&) noexcept;

  /// Π of the factors and of the reflectance, colour by colour; RGB.
  /// @param factors     at most 255
  /// @param reflectance nullptr for none; its pyramid must outlive the call
  Tree make(std::span<const ProjectionFactor> factors, const RotatedReflectance* reflectance);

  /// The average of the last product, before pruning.
  Rgb mean() const;
  const ProjectionReport& report() const;

private:
  class Projection;
  std::unique_ptr<Projection> m_projection;
};

} // namespace haarlight::wavelet
