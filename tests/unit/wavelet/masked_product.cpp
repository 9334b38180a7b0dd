// Products of light and reflectance seen through masks.

#include "lobe_trees.h"
#include "random_map.h"

#include <wavelet/product/adaptive_product.h>
#include <wavelet/product/multiply.h>
#include <wavelet/product/region.h>
#include <wavelet/square/square_cap.h>

#include <catch2/catch.hpp>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

/// Directions w with w·axis > cosine.
class Lid : public Region {
public:
  Lid(const Vec3& axis, float cosine) : m_axis(axis.normalized()), m_cosine(cosine) {}

  RegionPart classify(const Square& square) const override {
    if (square.level < 3)
      return RegionPart::Partial;
    const float share = coverage(square);
    return share == 0 ? RegionPart::Outside : share == 1 ? RegionPart::Inside : RegionPart::Partial;
  }
  float coverage(const Square& square) const override {
    return positive_fraction_of(square, [&](Float4 x, Float4 y, Float4 z) {
      return x * m_axis.x() + y * m_axis.y() + z * m_axis.z() - m_cosine;
    });
  }

private:
  Vec3 m_axis;
  float m_cosine;
};

/// A light, a reflectance about n, and masks of which the first leaves nothing near the horizon.
struct Setting {
  Vec3 n = Vec3(0.3F, 0.5F, 0.6F).normalized();
  Tree light = tree_of(random_map(128, 4), 0.02);
  Tree lobes[2] = {tree_of(lobe_map(64, 0), 0), tree_of(lobe_map(64, 1), 0)};
  Pyramid pyramid = Pyramid(std::vector{lobes[0].view(), lobes[1].view()});
  Tree masks[2] = {region_tree(Lid(n, 0.4F), 6), region_tree(Lid(Vec3(0.9F, 0.1F, 0.2F), 0.3F), 7)};
  AdaptiveProduct builder = AdaptiveProduct(light.view());

  const ProductTree& product() {
    AdaptiveOptions options;
    options.variance_bound = 0.02F;
    return builder.build(reflectance_at(pyramid, n, n, 0), options);
  }
};

Rgb sum_of(std::span<const MaskedLeaf> leaves) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const MaskedLeaf& leaf : leaves)
    sum += (to_rgb(leaf.visible_light) * leaf.square.area()).cast<double>();
  return sum.cast<float>();
}

bool close(const Rgb& a, const Rgb& b) { return ((a - b) / b).abs().maxCoeff() < 1e-5F; }

} // namespace

TEST_CASE("masked leaves hold the product of light and masks", "[masked]") {
  Setting s;
  MaskedProduct masked;
  const std::vector<TreeView> one = {s.masks[0].view()};
  const std::vector<TreeView> two = {s.masks[0].view(), s.masks[1].view()};
  for (const auto& masks : {one, two, one}) {
    std::vector<TreeView> all = masks;
    all.push_back(s.light.view());
    CHECK(close(sum_of(masked.build(s.product(), masks)), product_integral(all)));
  }
}

TEST_CASE("masked leaves may be split as far as wanted", "[masked]") {
  Setting s;
  MaskedProduct masked;
  const std::vector<TreeView> views = {s.masks[0].view(), s.masks[1].view()};
  const auto leaves = masked.build(s.product(), views);
  std::vector<MaskedLeaf> all(leaves.begin(), leaves.end());
  const Rgb before = sum_of(all);
  std::vector<MaskedLeaf> next;
  for (int pass = 0; pass < 3; ++pass) {
    next.clear();
    for (const MaskedLeaf& leaf : all)
      masked.split(leaf, next);
    CHECK(next.size() > all.size());
    CHECK(close(sum_of(next), before));
    all.swap(next);
  }
  const std::vector<TreeView> factors = {s.masks[0].view(), s.masks[1].view(), s.light.view()};
  const Tree product = multiply(factors);
  for (std::size_t i = 0; i < all.size(); i += 97) {
    const Square& place = all[i].square;
    const Rgb expected = product.view().average(place.level, static_cast<int>(place.column),
                                                static_cast<int>(place.row));
    CHECK((to_rgb(all[i].visible_light) - expected).abs().maxCoeff() <
          1e-4F * (1 + expected.maxCoeff()));
  }
}

TEST_CASE("nothing is left behind a mask of nothing", "[masked]") {
  Setting s;
  MaskedProduct masked;
  const Tree nothing = region_tree(Lid(Vec3::UnitZ(), 2), 4);
  const std::vector<TreeView> views = {s.masks[0].view(), nothing.view()};
  CHECK(nothing.mean[0] == 0);
  CHECK(masked.build(s.product(), views).empty());
}
