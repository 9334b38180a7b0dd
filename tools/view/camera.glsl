// What a pixel sees, and where its reflectance is found.

uniform vec3 ray_origin, ray_origin_x, ray_origin_y; // of film point (0, 0); per pixel to the right
uniform vec3 ray_towards, ray_towards_x, ray_towards_y; // and down; directions of any length
uniform vec2 pixel_size; // in world units at the camera, and what is added per unit of distance
uniform int forced_level; // -1: as the pixel needs

out vec4 colour;

bool see(out Hit hit, out vec3 direction) {
  vec2 film = gl_FragCoord.xy;
  vec3 origin = ray_origin + film.x * ray_origin_x + film.y * ray_origin_y;
  direction = normalize(ray_towards + film.x * ray_towards_x + film.y * ray_towards_y);
  return nearest(origin, direction, hit);
}

struct Lobe {
  mat3 frame; // x, y, z of the reflection frame, as reflection_frame() has it
  float cosine; // of θ_r
  vec4 object; // the second texel of the object
  float column; // among those of the object's set, counted from the centre of its first
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
