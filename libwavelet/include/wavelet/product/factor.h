#pragma once
// What products are made of: anything that can give its average over a square of the one domain.
//
// All factors of a product share one frame. A product walks the squares level by level and asks
// every factor for the quadrants of many squares at once, so that the call itself costs nothing.

#include <wavelet/product/adaptive_product.h>
#include <wavelet/square/square_place.h>
#include <wavelet/square/symmetry.h>
#include <wavelet/tree/tree.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace haarlight::wavelet {

/// Many squares as one factor sees them: square i has the average mean[slot[i]], and
/// detail[slot[i]] is the factor's own handle on what lies below; no_node says that it is constant
/// there.
struct FactorSquares {
  const SquarePlace* place; ///< by square; nullptr if no factor needs it
  const std::int32_t* slot;
  const Float4* mean; ///< lanes R, G, B, *
  const std::uint32_t* detail;
  std::size_t count;
};

/// Where the quadrants q = qx + 2 qy of square i go: at 4 i + q.
struct FactorQuadrants {
  Float4* mean;
  std::uint32_t* detail;
};

/// A non-negative RGB function on the unit square, known by its averages.
class Factor {
public:
  virtual ~Factor() = default;

  /// Average over the whole square, lanes R, G, B, 0, and the handle on what lies below.
  virtual Float4 mean() const = 0;
  virtual std::uint32_t root() const = 0;

  /// Averages and handles of the squares' quadrants. Squares that are constant are split like any.
  virtual void split(const FactorSquares& squares, const FactorQuadrants& out) const = 0;

  /// Whether split() looks at places; if no factor's does, nobody keeps track of them.
  virtual bool needs_places() const { return true; }

  /// The tree that this is and that its handles are nodes of, or nullptr: below a square on which
  /// all other factors are constant, a product is then left to it.
  virtual const TreeView* tree() const { return nullptr; }
};

namespace detail {

/// How a symmetry of the square moves a node's quadrants and differences.
struct TreeTurn {
  std::array<unsigned, 4> stored; ///< the stored quadrant that stands for each
  bool plain;                     ///< which is the quadrant itself
  bool swaps;                     ///< differences along x are stored along y
  float sign_x, sign_y;           ///< of the differences along x and y, as they are seen

  explicit TreeTurn(const SquareSymmetry& symmetry);
};

} // namespace detail

/// A stored tree, seen through the square's symmetry.
class TreeFactor final : public Factor {
public:
  /// @param view its arrays must outlive this
  explicit TreeFactor(const TreeView& view, const SquareSymmetry& symmetry = {});

  Float4 mean() const override { return to_lanes(m_view.mean); }
  std::uint32_t root() const override { return m_view.root(); }
  void split(const FactorSquares& squares, const FactorQuadrants& out) const override;
  bool needs_places() const override { return false; }
  const TreeView* tree() const override { return m_turn.plain ? &m_view : nullptr; }

private:
  TreeView m_view;
  detail::TreeTurn m_turn;
};

/// The same everywhere.
class ConstantFactor final : public Factor {
public:
  explicit ConstantFactor(const Rgb& value) : m_value(to_lanes(value)) {}

  Float4 mean() const override { return m_value; }
  std::uint32_t root() const override { return no_node; }
  void split(const FactorSquares& squares, const FactorQuadrants& out) const override;
  bool needs_places() const override { return false; }

private:
  Float4 m_value;
};

/// A reflectance seen through a rotation: averages of its pyramid about the rotated centres of
/// squares. Approximate, since a rotated square is none; products with it end at its finest level.
class RotatedFactor final : public Factor {
public:
  /// @param reflectance its pyramid must outlive this
  explicit RotatedFactor(const RotatedReflectance& reflectance) : m_reflectance(reflectance) {}

  Float4 mean() const override;
  std::uint32_t root() const override { return 0; }
  void split(const FactorSquares& squares, const FactorQuadrants& out) const override;

private:
  RotatedReflectance m_reflectance;
};

} // namespace haarlight::wavelet
