// The picture under one lamp: reflectance from trees at the level that the pixel needs.

uniform vec4 lamp;       // unit direction towards it and 0, or its position and 1
uniform vec3 irradiance; // of a surface facing it, at distance 1 if it has a position

/// The level whose squares are no wider than what the mirror direction sweeps over in one pixel:
/// it turns by twice the normal's turn, and with the view.
int needed_level(Hit hit, Lobe lobe) {
  float radius = texelFetch(objects, ivec2(0, hit.object), 0).w;
  float curvature = lobe.object.x == 0.0 ? 1.0 / radius : 0.0;
  float width = (pixel_size.x + pixel_size.y * hit.t) * inversesqrt(max(lobe.cosine, 0.01));
  float swept = max(2.0 * width * curvature + pixel_size.y, 1e-6);
  return int(ceil(log2(sqrt(4.0 * pi) / swept)));
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
  vec3 towards = lamp.xyz - lamp.w * hit.position;
  float distance = length(towards);
  vec3 direction = towards / distance;
  bool dark = dot(hit.normal, direction) <= 0.0 ||
              occluded(leave(hit.position, hit.normal), direction, lamp.w > 0.0 ? distance : far);
  vec3 arriving = lamp.w > 0.0 ? irradiance / (distance * distance) : irradiance;
  return dark ? vec3(0.0) : reflectance(hit, wo, direction) * arriving;
}

void main() {
  Hit hit;
  vec3 direction;
  colour = vec4(0.0);
  int hits = see(hit, direction) ? 1 : 0; // a loop, since llvmpipe runs branches that no pixel takes
  for (int i = 0; i < hits; ++i)
    colour = vec4(shade(hit, -direction), accesses);
}
