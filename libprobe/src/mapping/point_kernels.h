#pragma once
// The inner loops of resampling: many points of the square at once, with the widest lanes the CPU
// has and the same results on every CPU.

#include <probe/mapping.h>

#include <cstdint>

namespace haarlight::probe {

/// Points are taken by as many; counts are multiples of it.
inline constexpr int point_step = 8;

/// A row of points of the square: (first_u + i·step, v).
struct PointRow {
  float first_u = 0;
  float step = 0;
  float v = 0;
  int count = 0; ///< a multiple of point_step
};

/// Points of the square, row by row: (first_u + i·step_u, first_v + j·step_v).
struct PointGrid {
  float first_u = 0;
  float first_v = 0;
  float step_u = 0;
  float step_v = 0;
  int columns = 0; ///< a multiple of point_step
  int rows = 0;
};

/// Shape of a probe's picture.
struct PictureShape {
  Mapping mapping = Mapping::Angular;
  int width = 0;
  int height = 0;
};

/// The pixels (row · width + column) of an image at the world directions of the points.
void find_texels(const PictureShape& shape, const PointGrid& points, std::int32_t* texels);

/// Where the directions of the points, local to a frame, fall in a world map of size × size pixels
/// with a border of one, in pixels from the centre of the border's first.
void find_places(const Frame& frame, int size, const PointRow& points, float* columns, float* rows);

/// The same with four lanes; used by find_texels and find_places on CPUs without wider ones.
namespace narrow {
void find_texels(const PictureShape& shape, const PointGrid& points, std::int32_t* texels);
void find_places(const Frame& frame, int size, const PointRow& points, float* columns, float* rows);
} // namespace narrow

} // namespace haarlight::probe
