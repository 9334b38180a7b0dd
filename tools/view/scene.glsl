// Spheres and planes, and where rays meet them.

/// Two texels per object: centre and radius, or unit normal and height; then 0 for a sphere and 1
/// for a plane, and of its trees the first column, the number of columns and of levels.
uniform highp sampler2D objects;
uniform int object_count;

const float far = 1e30;

struct Hit {
  float t;
  int object;
  vec3 position;
  vec3 normal;
};

float meet_sphere(vec3 origin, vec3 direction, vec4 sphere) {
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

float meet_plane(vec3 origin, vec3 direction, vec4 plane) {
  float slope = dot(plane.xyz, direction);
  float t = (plane.w - dot(plane.xyz, origin)) / (slope == 0.0 ? 1e-30 : slope);
  return t > 0.0 && slope != 0.0 ? t : far;
}

float meet(vec3 origin, vec3 direction, int object) {
  vec4 form = texelFetch(objects, ivec2(0, object), 0);
  bool sphere = texelFetch(objects, ivec2(1, object), 0).x == 0.0;
  return sphere ? meet_sphere(origin, direction, form) : meet_plane(origin, direction, form);
}

bool occluded(vec3 origin, vec3 direction, float t_max) {
  for (int i = 0; i < object_count; ++i)
    if (meet(origin, direction, i) < t_max)
      return true;
  return false;
}

/// Position and normal, the latter on the viewer's side.
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
    float t = meet(origin, direction, i);
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

/// A point off the surface, as offset_origin() of the renderer.
vec3 leave(vec3 position, vec3 normal) {
  vec3 size = abs(position);
  float largest = max(size.x, max(size.y, size.z));
  return position + normal * (9.5367431640625e-7 * (largest + 0.00390625));
}
