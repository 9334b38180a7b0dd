precision highp float;
precision highp int;

const float pi = 3.14159265358979;

/// Accesses of this fragment to textures that hold trees.
float accesses = 0.0;

/// The square point of a unit direction: octahedral equal-area (Clarberg 2008), as sphere_map.h.
vec2 sphere_to_square(vec3 w) {
  vec2 a = abs(w.xy);
  float r = sqrt(dot(a, a) / (1.0 + abs(w.z)));
  float total = a.x + a.y;
  float along_v = r * (0.5 + atan((a.y - a.x) / (total > 0.0 ? total : 1.0)) * (2.0 / pi));
  vec2 p = vec2(r - along_v, along_v);
  if (w.z < 0.0)
    p = vec2(1.0) - p.yx;
  return 0.5 + 0.5 * vec2(w.x < 0.0 ? -p.x : p.x, w.y < 0.0 ? -p.y : p.y);
}

