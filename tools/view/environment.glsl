// The picture under a distant light: the integral of reflectance times light over its squares, as
// packed_light.h and packed_lobes.h lay them out.

uniform highp sampler2D light_squares, light_directions; // mip level k: squares of light_levels - k
uniform highp sampler3D lobes;
uniform float light_unit, lobe_unit;
uniform int light_levels, lobe_levels;
uniform mat3 to_world; // from the light's frame
uniform float tolerance; // squares are split while they leave more of the integral in doubt
uniform bool background;

const int full_level = 5;
const float even_spread = 1.4472025;

vec4 light_square(int level, ivec2 square) {
  accesses += 1.0;
  vec4 light = texelFetch(light_squares, square, light_levels - level);
  return vec4(light.rgb * light_unit, light.a);
}

vec3 light_around(int level, vec3 direction) {
  int side = 1 << level;
  ivec2 square = ivec2(sphere_to_square(direction * to_world) * float(side));
  return light_square(level, min(square, ivec2(side - 1))).rgb;
}

/// The finest squares, blended.
vec3 light_towards(vec3 direction) {
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

/// The reflectance's average over a square of `level` about a point, and its deviation within;
/// `column` counts from the centre of the first of all.
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

/// How far a direction is from an object's edge, in radians; negative where the object is.
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

/// How much of something `width` wide, in radians, is visible about a direction.
float visible(Hit hit, vec3 direction, float width) {
  float part = 1.0;
  for (int i = 0; i < object_count; ++i)
    if (i != hit.object)
      part *= clamp(0.5 + clearance(i, hit, direction) / width, 0.0, 1.0);
  return part;
}

float brightness(vec3 colour) { return dot(colour, vec3(0.2126, 0.7152, 0.0722)); }

/// About how large the average product will be: light of the squares that are as large as the lobe,
/// as far as that is visible.
float expected(Hit hit, float column, vec3 mirror) {
  vec4 whole = lobe(0, vec2(0.5), column);
  float mean = max(brightness(whole.rgb), 1e-30);
  float variance = whole.a * whole.a / (mean * mean);
  int level = min(int(0.5 * log2(1.0 + variance)), light_levels);
  float width = 2.45 * even_spread * exp2(float(-level));
  float seen = max(visible(hit, mirror, width), 0.05);
  return mean * brightness(light_around(level, mirror)) * seen;
}

/// Steps to the square that follows in Morton order, no finer; false after the last.
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
  float doubt_allowed = tolerance * expected(hit, column, place.frame[2]);
  int finest = forced_level >= 0 ? min(forced_level, light_levels) : light_levels;
  vec3 sum = vec3(0.0);
  int level = 0;
  ivec2 square = ivec2(0);
  for (;;) {
    vec4 light = light_square(level, square);
    vec3 direction = texelFetch(light_directions, square, light_levels - level).xyz;
    accesses += 1.0;
    float area = exp2(float(-2 * level));
    int lobe_level = max(int(log2(even_spread / max(light.a, 1e-4))), level);
    vec4 reflectance = lobe(lobe_level, sphere_to_square(to_lobe * direction), column);
    float seen = visible(hit, to_world * direction, 2.45 * max(light.a, 1e-4));
    float in_doubt = seen * reflectance.a +
                     (seen > 0.0 && seen < 1.0 ? 0.5 * brightness(reflectance.rgb) : 0.0);
    if (level < finest && area * brightness(light.rgb) * in_doubt > doubt_allowed) {
      ++level;
      square <<= 1;
      continue;
    }
    sum += light.rgb * reflectance.rgb * (seen * area);
    if (!next_square(level, square))
      break;
  }
  return sum * (4.0 * pi);
}

void main() {
  Hit hit;
  vec3 direction;
  if (see(hit, direction))
    colour = vec4(reflected(hit, -direction), accesses);
  else
    colour = vec4(background ? light_towards(direction) : vec3(0.0), 0.0);
}
