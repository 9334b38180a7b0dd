// A directional or point light: reflectance from trees at the level that the pixel needs. packing.h
// describes the textures.

uniform vec4 light; // unit direction towards the light and 0, or its position and 1
uniform vec3 irradiance; // of a surface that faces the light; for a point light at distance 1

uniform highp sampler3D coarse_averages;
uniform highp usampler2D subtree_roots;
uniform highp sampler2D scales;
uniform highp usampler2D links;
uniform highp sampler2D coefficients;
uniform float coarse_unit;

const int dense_level = 5;
const int dense_side = 1 << dense_level;
const int nodes_per_row = 512;

/// The average over a square of a dense level, interpolated between columns by the texture unit.
vec3 dense_average(int level, ivec2 cell, float column) {
  ivec2 origin = level == dense_level ? ivec2(0) : ivec2(dense_side, dense_side - (2 << level));
  vec3 place = vec3(vec2(origin + cell), column) + 0.5;
  accesses += 1.0;
  return textureLod(coarse_averages, place / vec3(textureSize(coarse_averages, 0)), 0.0).rgb * coarse_unit;
}

/// The child of a node in a quadrant, plus 1; 0 for none.
uint child_of(uint link, int quadrant) {
  if (((link >> quadrant) & 1u) == 0u)
    return 0u;
  uint before = link & ((1u << quadrant) - 1u);
  uint count = (before & 1u) + ((before >> 1) & 1u) + ((before >> 2) & 1u);
  return (link >> 4) + count + 1u;
}

/// Sum of the differences below dense_level in a square of a finer level of one column.
vec3 finer_details(int column, int level, ivec2 cell) {
  ivec2 start = cell >> (level - dense_level);
  uint node = texelFetch(subtree_roots, ivec2(start.y * dense_side + start.x, column), 0).r;
  vec3 sum = vec3(0.0);
  accesses += 2.0;
  for (int l = level - dense_level - 1; l >= 0 && node != 0u; --l) {
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

/// The average over the square of `level` around a point, interpolated between the trees of a set at
/// `column` (relative to the first column of the set); never negative.
vec3 tree_average(int first, int columns, float column, int level, vec2 point) {
  int side = 1 << level;
  ivec2 cell = clamp(ivec2(point * float(side)), ivec2(0), ivec2(side - 1));
  int top = min(level, dense_level);
  vec3 value = dense_average(top, cell >> (level - top), float(first) + column);
  if (level > dense_level) {
    int below = int(column);
    int above = min(below + 1, columns - 1);
    value += mix(finer_details(first + below, level, cell),
                 finer_details(first + above, level, cell), column - float(below));
  }
  return max(value, 0.0);
}

/// The level whose squares are no wider than the range of mirror directions in one pixel, which turn
/// by twice the change of the normal, and with the view direction.
int needed_level(Hit hit, Lobe lobe) {
  float radius = texelFetch(objects, ivec2(0, hit.object), 0).w;
  float curvature = lobe.object.x == 0.0 ? 1.0 / radius : 0.0;
  float width = (pixel_size.x + pixel_size.y * hit.t) * inversesqrt(max(lobe.cosine, 0.01));
  float range = max(2.0 * width * curvature + pixel_size.y, 1e-6);
  return int(ceil(log2(sqrt(4.0 * pi) / range)));
}

/// f_r cos of the light direction, sr⁻¹.
vec3 reflectance(Hit hit, vec3 wo, vec3 direction) {
  Lobe lobe = lobe_at(hit, wo);
  int level = clamp(forced_level >= 0 ? forced_level : needed_level(hit, lobe), 0,
                    int(lobe.object.w));
  return tree_average(int(lobe.object.y), int(lobe.object.z), lobe.column, level,
                      sphere_to_square(direction * lobe.frame));
}

vec3 shade(Hit hit, vec3 wo) {
  vec3 towards = light.xyz - light.w * hit.position;
  float distance = length(towards);
  vec3 direction = towards / distance;
  bool unlit = dot(hit.normal, direction) <= 0.0 ||
              occluded(offset_origin(hit.position, hit.normal), direction, light.w > 0.0 ? distance : far);
  vec3 incident = light.w > 0.0 ? irradiance / (distance * distance) : irradiance;
  return unlit ? vec3(0.0) : reflectance(hit, wo, direction) * incident;
}

void main() {
  Hit hit;
  vec3 direction;
  colour = vec4(0.0);
  int hits = camera_hit(hit, direction) ? 1 : 0; // a loop, since llvmpipe runs branches that no pixel takes
  for (int i = 0; i < hits; ++i)
    colour = vec4(shade(hit, -direction), accesses);
}
