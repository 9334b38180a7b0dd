// Reads trees as packed_trees.h lays them out.

uniform highp sampler3D tops;
uniform highp usampler2D starts;
uniform highp sampler2D scales;
uniform highp usampler2D links;
uniform highp sampler2D coefficients;
uniform float top_unit;

const int top_level = 5;
const int top_side = 1 << top_level;
const int nodes_per_row = 512;

/// The average over a square of a dense level, filtered between columns by the texture unit.
/// `column` counts from the centre of the first.
vec3 top_average(int level, ivec2 cell, float column) {
  ivec2 origin = level == top_level ? ivec2(0) : ivec2(top_side, top_side - (2 << level));
  vec3 place = vec3(vec2(origin + cell), column) + 0.5;
  accesses += 1.0;
  return textureLod(tops, place / vec3(textureSize(tops, 0)), 0.0).rgb * top_unit;
}

/// A node's child in a quadrant, counted from 1; 0 for none.
uint child_of(uint link, int quadrant) {
  if (((link >> quadrant) & 1u) == 0u)
    return 0u;
  uint before = link & ((1u << quadrant) - 1u);
  uint count = (before & 1u) + ((before >> 1) & 1u) + ((before >> 2) & 1u);
  return (link >> 4) + count + 1u;
}

/// What the levels from top_level on add in a square of a finer level of one column.
vec3 finer_details(int column, int level, ivec2 cell) {
  ivec2 start = cell >> (level - top_level);
  uint node = texelFetch(starts, ivec2(start.y * top_side + start.x, column), 0).r;
  vec3 sum = vec3(0.0);
  accesses += 2.0;
  for (int l = level - top_level - 1; l >= 0 && node != 0u; --l) {
    int i = int(node) - 1;
    ivec2 place = ivec2(i % nodes_per_row, i / nodes_per_row);
    ivec2 q = (cell >> l) & 1;
    vec2 s = 1.0 - 2.0 * vec2(q);
    accesses += 4.0;
    sum += s.x * texelFetch(coefficients, ivec2(3 * place.x, place.y), 0).rgb +
           s.y * texelFetch(coefficients, ivec2(3 * place.x + 1, place.y), 0).rgb +
           s.x * s.y * texelFetch(coefficients, ivec2(3 * place.x + 2, place.y), 0).rgb;
    node = child_of(texelFetch(links, place, 0).r, q.x + 2 * q.y);
  }
  return sum * texelFetch(scales, ivec2(column, 0), 0).r;
}

/// The average over the square of `level` around a point, of a set's trees blended at `column`
/// (from the set's first); never negative.
vec3 tree_average(int first, int columns, float column, int level, vec2 point) {
  int side = 1 << level;
  ivec2 cell = clamp(ivec2(point * float(side)), ivec2(0), ivec2(side - 1));
  int top = min(level, top_level);
  vec3 value = top_average(top, cell >> (level - top), float(first) + column);
  if (level > top_level) {
    int below = int(column);
    int above = min(below + 1, columns - 1);
    value += mix(finer_details(first + below, level, cell),
                 finer_details(first + above, level, cell), column - float(below));
  }
  return max(value, 0.0);
}
