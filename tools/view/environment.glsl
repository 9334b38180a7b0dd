// A distant light: the integral of reflectance times light over the light's squares. packing.h
// describes the textures.

uniform highp sampler2D light_squares, light_directions; // mip level k: squares of light_levels - k
uniform highp sampler3D lobes;
uniform float light_unit, lobe_unit;
uniform int light_levels, lobe_levels;
uniform mat3 to_world; // from the light's frame
uniform float tolerance; // squares are split while their error is a larger fraction of the pixel
uniform bool show_background;

const int full_level = 5;
const float uniform_spread = 1.4472025;

vec4 light_square(int level, ivec2 square) {
  accesses += 1.0;
  vec4 light = texelFetch(light_squares, square, light_levels - level);
  return vec4(light.rgb * light_unit, light.a);
}

/// The square of a level around a direction.
vec3 light_around(int level, vec3 direction) {
  int side = 1 << level;
  ivec2 square = ivec2(sphere_to_square(direction * to_world) * float(side));
  return light_square(level, min(square, ivec2(side - 1))).rgb;
}

/// Radiance from a direction, bilinear between the finest squares.
vec3 light_radiance(vec3 direction) {
  int last = (1 << light_levels) - 1;
  vec2 place = sphere_to_square(direction * to_world) * float(last + 1) - 0.5;
  ivec2 first = ivec2(floor(place));
  vec2 part = place - vec2(first);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 corner = ivec2(i & 1, i >> 1);
    vec2 weight = mix(1.0 - part, part, vec2(corner));
    ivec2 square = clamp(first + corner, ivec2(0), ivec2(last));
    sum += weight.x * weight.y * light_square(light_levels, square).rgb;
  }
  return sum;
}

/// Average and standard deviation of the reflectance over a square of `level` about a point;
/// `column` 0 is the centre of the first column of all sets.
vec4 lobe(int level, vec2 point, float column) {
  vec2 middle = abs(point - 0.5);
  int within = int(float(full_level - 1) - log2(max(max(middle.x, middle.y), 1e-3)));
  int l = min(min(level, lobe_levels), within);
  float window = float(1 << full_level);
  float side = float(1 << l);
  vec2 texel = l < full_level ? point * side + vec2(1.0, side + float(2 * l))
                              : (point - 0.5) * side + 0.5 * window +
                                    vec2(1.0, window + float(2 * full_level) +
                                                  (window + 2.0) * float(l - full_level));
  accesses += 1.0;
  vec3 size = vec3(textureSize(lobes, 0));
  vec4 value = textureLod(lobes, vec3(texel, column + 0.5) / size, 0.0) * lobe_unit;
  value.a *= exp2(float(l - level));
  return value;
}

/// Angle between a direction and an object's silhouette, radians; negative inside.
float clearance(int object, Hit hit, vec3 direction) {
  vec4 form = texelFetch(objects, ivec2(0, object), 0);
  if (texelFetch(objects, ivec2(1, object), 0).x != 0.0) {
    float height = dot(form.xyz, hit.position) - form.w;
    return asin(clamp(dot(form.xyz, direction), -1.0, 1.0)) * (height < 0.0 ? -1.0 : 1.0);
  }
  vec3 towards = form.xyz - hit.position;
  float along = dot(towards, direction);
  float tangent = sqrt(max(dot(towards, towards) - form.w * form.w, 0.0));
  return atan(length(towards - along * direction), along) - atan(form.w, tangent);
}

/// Visible fraction of a square of angular width `width`, radians, about a direction.
float visible_fraction(Hit hit, vec3 direction, float width) {
  float part = 1.0;
  for (int i = 0; i < object_count; ++i)
    if (i != hit.object)
      part *= clamp(0.5 + clearance(i, hit, direction) / width, 0.0, 1.0);
  return part;
}

float luminance(vec3 colour) { return dot(colour, vec3(0.2126, 0.7152, 0.0722)); }

/// Estimate of the pixel: average reflectance times the visible light of the squares as large as the
/// lobe.
float estimate(Hit hit, float column, vec3 mirror) {
  vec4 whole = lobe(0, vec2(0.5), column);
  float mean = max(luminance(whole.rgb), 1e-30);
  float variance = whole.a * whole.a / (mean * mean);
  int level = min(int(0.5 * log2(1.0 + variance)), light_levels);
  float width = 2.45 * uniform_spread * exp2(float(-level));
  float visible = max(visible_fraction(hit, mirror, width), 0.05);
  return mean * luminance(light_around(level, mirror)) * visible;
}

/// Advances to the next square in Morton order, at the same level or a coarser one; false after the
/// last.
bool next_square(inout int level, inout ivec2 square) {
  for (; (square.x & square.y & 1) == 1; --level)
    square >>= 1;
  if (level <= 0)
    return false;
  square += (square.x & 1) == 0 ? ivec2(1, 0) : ivec2(-1, 1);
  return true;
}

vec3 reflected(Hit hit, vec3 wo) {
  Lobe place = lobe_at(hit, wo);
  mat3 to_lobe = transpose(place.frame) * to_world;
  float column = place.object.y + place.column;
  float error_allowed = tolerance * estimate(hit, column, place.frame[2]);
  int finest = forced_level >= 0 ? min(forced_level, light_levels) : light_levels;
  vec3 sum = vec3(0.0);
  int level = 0;
  ivec2 square = ivec2(0);
  for (;;) {
    vec4 light = light_square(level, square);
    vec3 direction = texelFetch(light_directions, square, light_levels - level).xyz;
    accesses += 1.0;
    float area = exp2(float(-2 * level));
    int lobe_level = max(int(log2(uniform_spread / max(light.a, 1e-4))), level);
    vec4 reflectance = lobe(lobe_level, sphere_to_square(to_lobe * direction), column);
    float visible = visible_fraction(hit, to_world * direction, 2.45 * max(light.a, 1e-4));
    float deviation = visible * reflectance.a +
                     (visible > 0.0 && visible < 1.0 ? 0.5 * luminance(reflectance.rgb) : 0.0);
    if (level < finest && area * luminance(light.rgb) * deviation > error_allowed) {
      ++level;
      square <<= 1;
      continue;
    }
    sum += light.rgb * reflectance.rgb * (visible * area);
    if (!next_square(level, square))
      break;
  }
  return sum * (4.0 * pi);
}

void main() {
  Hit hit;
  vec3 direction;
  if (camera_hit(hit, direction))
    colour = vec4(reflected(hit, -direction), accesses);
  else
    colour = vec4(show_background ? light_radiance(direction) : vec3(0.0), 0.0);
}
