// The picture under one lamp: reflectance from trees at the level that the pixel needs.

uniform vec3 ray_origin, ray_origin_x, ray_origin_y; // of film point (0, 0); per pixel to the right
uniform vec3 ray_towards, ray_towards_x, ray_towards_y; // and down; directions of any length
uniform vec2 pixel_size; // in world units at the camera, and what is added per unit of distance
uniform vec4 lamp;       // unit direction towards it and 0, or its position and 1
uniform vec3 irradiance; // of a surface facing it, at distance 1 if it has a position
uniform int forced_level; // -1: as the pixel needs

out vec4 colour;

/// x, y, z of the reflection frame as columns, as reflection_frame() has it; sine and cosine of θ_r.
mat3 reflection_frame(vec3 n, vec3 wo, out vec2 theta) {
  vec3 z = normalize(2.0 * dot(n, wo) * n - wo);
  float cosine = dot(n, z);
  vec3 across = n - cosine * z;
  theta = vec2(length(across), cosine);
  vec3 any = abs(z.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
  vec3 x = theta.x < 1e-6 ? normalize(any - dot(any, z) * z) : across / theta.x;
  return mat3(x, cross(z, x), z);
}

/// The level whose squares are no wider than what the mirror direction sweeps over in one pixel:
/// it turns by twice the normal's turn, and with the view.
int needed_level(Hit hit, float cosine, vec4 object) {
  float radius = texelFetch(objects, ivec2(0, hit.object), 0).w;
  float curvature = object.x == 0.0 ? 1.0 / radius : 0.0;
  float width = (pixel_size.x + pixel_size.y * hit.t) * inversesqrt(max(cosine, 0.01));
  float swept = max(2.0 * width * curvature + pixel_size.y, 1e-6);
  return clamp(int(ceil(log2(sqrt(4.0 * pi) / swept))), 0, int(object.w));
}

/// f_r cos of the light direction, sr⁻¹.
vec3 reflectance(Hit hit, vec3 wo, vec3 direction) {
  vec4 object = texelFetch(objects, ivec2(1, hit.object), 0);
  vec2 theta;
  mat3 frame = reflection_frame(hit.normal, wo, theta);
  float column = clamp(atan(theta.x, theta.y) * (2.0 / pi) * object.z - 0.5, 0.0, object.z - 1.0);
  int level = forced_level >= 0 ? min(forced_level, int(object.w))
                                : needed_level(hit, theta.y, object);
  return tree_average(int(object.y), int(object.z), column, level,
                      sphere_to_square(direction * frame));
}

vec3 shade(Hit hit, vec3 wo) {
  vec3 towards = lamp.xyz - lamp.w * hit.position;
  float distance = length(towards);
  vec3 direction = towards / distance;
  bool dark = dot(hit.normal, direction) <= 0.0 ||
              occluded(leave(hit.position, hit.normal), direction, lamp.w > 0.0 ? distance : far);
  vec3 arriving = lamp.w > 0.0 ? irradiance / (distance * distance) : irradiance;
  return dark ? vec3(0.0) : reflectance(hit, wo, direction) * arriving;
}

void main() {
  vec2 film = gl_FragCoord.xy;
  vec3 origin = ray_origin + film.x * ray_origin_x + film.y * ray_origin_y;
  vec3 direction = normalize(ray_towards + film.x * ray_towards_x + film.y * ray_towards_y);
  Hit hit;
  colour.rgb = nearest(origin, direction, hit) ? shade(hit, -direction) : vec3(0.0);
  colour.a = accesses;
}
