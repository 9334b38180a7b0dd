#include "mapping/point_kernels.h"

#include "mapping/mapping_lanes.h"

#include <wavelet/base/lanes.h>
#include <wavelet/square/sphere_map.h>

namespace haarlight::probe {

// Eight floats side by side (one AVX register), for code that is compiled for AVX2 and entered only
// where the CPU has it. As the lanes of <wavelet/base/lanes.h>, each computes what a float would,
// bit for bit; a class, so that those templates find these operators. Everything is inlined: as
// function arguments such registers have no agreed place without AVX.

using Raw8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

#define HAARLIGHT_INLINE [[gnu::always_inline]] inline

struct Mask8 {
  Int8 lanes;
};

struct Float8 {
  Raw8 lanes;

  HAARLIGHT_INLINE Float8() : lanes{} {}
  HAARLIGHT_INLINE explicit Float8(Raw8 values) : lanes(values) {}

  HAARLIGHT_INLINE friend Float8 operator+(Float8 a, Float8 b) { return Float8(a.lanes + b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator-(Float8 a, Float8 b) { return Float8(a.lanes - b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator*(Float8 a, Float8 b) { return Float8(a.lanes * b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator/(Float8 a, Float8 b) { return Float8(a.lanes / b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator+(Float8 a, float b) { return Float8(a.lanes + b); }
  HAARLIGHT_INLINE friend Float8 operator-(Float8 a, float b) { return Float8(a.lanes - b); }
  HAARLIGHT_INLINE friend Float8 operator*(Float8 a, float b) { return Float8(a.lanes * b); }
  HAARLIGHT_INLINE friend Float8 operator/(Float8 a, float b) { return Float8(a.lanes / b); }
  HAARLIGHT_INLINE friend Float8 operator+(float a, Float8 b) { return Float8(a + b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator-(float a, Float8 b) { return Float8(a - b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator*(float a, Float8 b) { return Float8(a * b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator/(float a, Float8 b) { return Float8(a / b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator-(Float8 a) { return Float8(-a.lanes); }
  HAARLIGHT_INLINE friend Mask8 operator<(Float8 a, Float8 b) { return {a.lanes < b.lanes}; }
  HAARLIGHT_INLINE friend Mask8 operator>(Float8 a, Float8 b) { return {a.lanes > b.lanes}; }
};

HAARLIGHT_INLINE Float8 select(Mask8 condition, Float8 yes, Float8 no) {
  return Float8(condition.lanes ? yes.lanes : no.lanes);
}

HAARLIGHT_INLINE Float8 square_root(Float8 x) {
  Raw8 roots;
  for (int i = 0; i < 8; ++i)
    roots[i] = std::sqrt(x.lanes[i]);
  return Float8(roots);
}

/// 0, 1, 2 … one for each lane.
template <class F>
F lane_numbers();
template <>
HAARLIGHT_INLINE Float4 lane_numbers<Float4>() {
  return Float4{0, 1, 2, 3};
}
template <>
HAARLIGHT_INLINE Float8 lane_numbers<Float8>() {
  return Float8(Raw8{0, 1, 2, 3, 4, 5, 6, 7});
}

/// The lanes as integers, rounded towards 0.
HAARLIGHT_INLINE Int4 truncated(Float4 x) { return __builtin_convertvector(x, Int4); }
HAARLIGHT_INLINE Int8 truncated(Float8 x) { return __builtin_convertvector(x.lanes, Int8); }

#undef HAARLIGHT_INLINE

namespace {

/// World or local direction of the points i, i + 1 … of a row.
template <class F>
void direction_of(const PointRow& points, int i, F& x, F& y, F& z) {
  const F u = (lane_numbers<F>() + static_cast<float>(i)) * points.step + points.first_u;
  wavelet::square_to_sphere(u, broadcast<F>(points.v), x, y, z);
}

template <class Map, class F>
void find_texels_by(const PictureShape& shape, const PointGrid& points, std::int32_t* texels) {
  const F last_column = broadcast<F>(static_cast<float>(shape.width - 1));
  const F last_row = broadcast<F>(static_cast<float>(shape.height - 1));
  PointRow line{points.first_u, points.step_u, points.first_v, points.columns};
  for (int j = 0; j < points.rows; ++j) {
    line.v = points.first_v + static_cast<float>(j) * points.step_v;
    for (int i = 0; i < points.columns;) {
      F x;
      F y;
      F z;
      F u;
      F v;
      direction_of(line, i, x, y, z);
      Map::image(x, y, z, u, v);
      const auto column = truncated(smaller(u * static_cast<float>(shape.width), last_column));
      const auto row = truncated(smaller(v * static_cast<float>(shape.height), last_row));
      const auto index = row * shape.width + column;
      __builtin_memcpy(texels, &index, sizeof index);
      constexpr int lanes = sizeof index / sizeof(std::int32_t);
      texels += lanes;
      i += lanes;
    }
  }
}

template <class F>
void find_texels_with(const PictureShape& shape, const PointGrid& points, std::int32_t* texels) {
  switch (shape.mapping) {
  case Mapping::Angular:
    return find_texels_by<AngularMap, F>(shape, points, texels);
  case Mapping::LatLong:
    return find_texels_by<LatLongMap, F>(shape, points, texels);
  case Mapping::MirrorBall:
    return find_texels_by<MirrorBallMap, F>(shape, points, texels);
  case Mapping::Octahedral:
    return find_texels_by<OctahedralMap, F>(shape, points, texels);
  }
}

template <class F>
void find_places_with(const Frame& f, int size, const PointRow& points, float* columns,
                      float* rows) {
  const F one = broadcast<F>(1);
  for (int i = 0; i < points.count;) {
    F lx;
    F ly;
    F lz;
    F u;
    F v;
    direction_of(points, i, lx, ly, lz);
    const F x = lx * f.t.x() + ly * f.b.x() + lz * f.n.x();
    const F y = lx * f.t.y() + ly * f.b.y() + lz * f.n.y();
    const F z = lx * f.t.z() + ly * f.b.z() + lz * f.n.z();
    wavelet::sphere_to_square(x, y, z, u, v);
    const F column = smaller(u, one) * static_cast<float>(size) + 0.5F;
    const F row = smaller(v, one) * static_cast<float>(size) + 0.5F;
    __builtin_memcpy(columns + i, &column, sizeof column);
    __builtin_memcpy(rows + i, &row, sizeof row);
    i += static_cast<int>(sizeof column / sizeof(float));
  }
}

// The only code compiled for AVX2: flattened, so that all it calls is too and nothing else is.
#if defined(__x86_64__)
[[gnu::target("avx2"), gnu::flatten]] void
find_texels_wide(const PictureShape& shape, const PointGrid& points, std::int32_t* texels) {
  find_texels_with<Float8>(shape, points, texels);
}

[[gnu::target("avx2"), gnu::flatten]] void find_places_wide(const Frame& frame, int size,
                                                            const PointRow& points, float* columns,
                                                            float* rows) {
  find_places_with<Float8>(frame, size, points, columns, rows);
}

bool has_wide_lanes() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

} // namespace

void narrow::find_texels(const PictureShape& shape, const PointGrid& points, std::int32_t* texels) {
  find_texels_with<Float4>(shape, points, texels);
}

void narrow::find_places(const Frame& frame, int size, const PointRow& points, float* columns,
                         float* rows) {
  find_places_with<Float4>(frame, size, points, columns, rows);
}

void find_texels(const PictureShape& shape, const PointGrid& points, std::int32_t* texels) {
#if defined(__x86_64__)
  if (has_wide_lanes())
    return find_texels_wide(shape, points, texels);
#endif
  narrow::find_texels(shape, points, texels);
}

void find_places(const Frame& frame, int size, const PointRow& points, float* columns,
                 float* rows) {
#if defined(__x86_64__)
  if (has_wide_lanes())
    return find_places_wide(frame, size, points, columns, rows);
#endif
  narrow::find_places(frame, size, points, columns, rows);
}

} // namespace haarlight::probe
