// The camera, and intersections of rays with spheres and planes.

/// Two texels per object: centre and radius, or unit normal and height; then 0 for a sphere or 1
/// for a plane, and of its trees the first column, the number of columns and the number of levels.
uniform highp sampler2D objects;
uniform int object_count;

const float far = 1e30;

struct Hit {
  float t;
  int object;
  vec3 position;
  vec3 normal;
};

float intersect_sphere(vec3 origin, vec3 direction, vec4 sphere) {
  vec3 towards = sphere.xyz - origin;
  float along = dot(towards, direction);
  vec3 across = towards - along * direction;
  float inside = sphere.w * sphere.w - dot(across, across);
  if (inside < 0.0)
    return far;
  float half_chord = sqrt(inside);
  float near_t = along - half_chord;
  float t = near_t > 0.0 ? near_t : along + half_chord;
  return t > 0.0 ? t : far;
}

float intersect_plane(vec3 origin, vec3 direction, vec4 plane) {
  float slope = dot(plane.xyz, direction);
  float t = (plane.w - dot(plane.xyz, origin)) / (slope == 0.0 ? 1e-30 : slope);
  return t > 0.0 && slope != 0.0 ? t : far;
}

float intersect(vec3 origin, vec3 direction, int object) {
  vec4 form = texelFetch(objects, ivec2(0, object), 0);
  bool sphere = texelFetch(objects, ivec2(1, object), 0).x == 0.0;
  return sphere ? intersect_sphere(origin, direction, form) : intersect_plane(origin, direction, form);
}

bool occluded(vec3 origin, vec3 direction, float t_max) {
  for (int i = 0; i < object_count; ++i)
    if (intersect(origin, direction, i) < t_max)
      return true;
  return false;
}

/// Position and normal, which faces the viewer.
void finish_hit(vec3 origin, vec3 direction, inout Hit hit) {
  vec4 form = texelFetch(objects, ivec2(0, hit.object), 0);
  hit.position = origin + hit.t * direction;
  hit.normal = form.xyz;
  if (texelFetch(objects, ivec2(1, hit.object), 0).x == 0.0) {
    hit.normal = normalize(hit.position - form.xyz);
    hit.position = form.xyz + form.w * hit.normal;
  }
  if (dot(hit.normal, direction) > 0.0)
    hit.normal = -hit.normal;
}

bool nearest(vec3 origin, vec3 direction, out Hit hit) {
  hit = Hit(far, -1, vec3(0.0), vec3(0.0));
  for (int i = 0; i < object_count; ++i) {
    float t = intersect(origin, direction, i);
    if (t < hit.t) {
      hit.t = t;
      hit.object = i;
    }
  }
  if (hit.object < 0)
    return false;
  finish_hit(origin, direction, hit);
  return true;
}

/// A ray origin off the surface, as offset_origin() of the renderer.
vec3 offset_origin(vec3 position, vec3 normal) {
  vec3 size = abs(position);
  float largest = max(size.x, max(size.y, size.z));
  return position + normal * (9.5367431640625e-7 * (largest + 0.00390625));
}

uniform vec3 ray_origin, ray_origin_x, ray_origin_y; // at film point (0, 0); change per pixel
uniform vec3 ray_direction, ray_direction_x, ray_direction_y; // to the right and down; any length
uniform vec2 pixel_size; // world units at the camera, and increase per unit of distance
uniform int forced_level; // -1: the level that the pixel needs

out vec4 colour;

/// The nearest object in the fragment's pixel.
bool camera_hit(out Hit hit, out vec3 direction) {
  vec2 film = gl_FragCoord.xy;
  vec3 origin = ray_origin + film.x * ray_origin_x + film.y * ray_origin_y;
  direction = normalize(ray_direction + film.x * ray_direction_x + film.y * ray_direction_y);
  return nearest(origin, direction, hit);
}

/// The trees of a hit.
struct Lobe {
  mat3 frame; // x, y, z of the reflection frame, as reflection_frame()
  float cosine; // of θ_r
  vec4 object; // the second texel of the object
  float column; // in the object's set; 0 is the centre of the first column
};

Lobe lobe_at(Hit hit, vec3 wo) {
  vec3 n = hit.normal;
  vec3 z = normalize(2.0 * dot(n, wo) * n - wo);
  float cosine = dot(n, z);
  vec3 across = n - cosine * z;
  float sine = length(across);
  vec3 any = abs(z.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
  vec3 x = sine < 1e-6 ? normalize(any - dot(any, z) * z) : across / sine;
  vec4 object = texelFetch(objects, ivec2(1, hit.object), 0);
  float column = clamp(atan(sine, cosine) * (2.0 / pi) * object.z - 0.5, 0.0, object.z - 1.0);
  return Lobe(mat3(x, cross(z, x), z), cosine, object, column);
}
