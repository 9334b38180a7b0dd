#include "mapping/point_kernels.h"

#include <wavelet/square/sphere_map.h>

#include <catch2/catch.hpp>

#include <cstdlib>
#include <vector>

using namespace haarlight;
using namespace haarlight::probe;

TEST_CASE("Wide lanes find the same texels as narrow ones", "[kernels]") {
  for (const Mapping mapping :
       {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall, Mapping::Octahedral}) {
    const PictureShape shape{mapping, 777, 777};
    constexpr int side = 256;
    const PointGrid points{0.5F / side, 0.5F / side, 1.0F / side, 1.0F / side, side, side};
    std::vector<std::int32_t> wide(side * side);
    std::vector<std::int32_t> four(wide.size());
    find_texels(shape, points, wide.data());
    narrow::find_texels(shape, points, four.data());
    CHECK(wide == four);
    for (int j = 0; j < side; j += 3)
      for (int i = 0; i < side; i += 3) {
        const Vec2 uv = direction_to_image(
            mapping, wavelet::square_to_sphere(Vec2((static_cast<float>(i) + 0.5F) / side,
                                                    (static_cast<float>(j) + 0.5F) / side)));
        const int x = static_cast<int>(uv.x() * 777);
        const int y = static_cast<int>(uv.y() * 777);
        const int texel = four[static_cast<std::size_t>(j * side + i)];
        // The points are not the same to the last bit.
        REQUIRE(std::abs(texel % 777 - x) <= 1);
        REQUIRE(std::abs(texel / 777 - y) <= 1);
      }
  }
}

TEST_CASE("Wide lanes find the same places as narrow ones", "[kernels]") {
  const Frame frame = frame_about(Vec3(0.3F, -0.5F, 0.4F).normalized());
  constexpr int count = 512;
  std::vector<float> wide[2] = {std::vector<float>(count), std::vector<float>(count)};
  std::vector<float> four[2] = {std::vector<float>(count), std::vector<float>(count)};
  for (int j = 0; j < 64; ++j) {
    const PointRow points{0.3F / count, 1.0F / count, (static_cast<float>(j) + 0.7F) / 64, count};
    find_places(frame, 128, points, wide[0].data(), wide[1].data());
    narrow::find_places(frame, 128, points, four[0].data(), four[1].data());
    REQUIRE(wide[0] == four[0]);
    REQUIRE(wide[1] == four[1]);
  }
}
