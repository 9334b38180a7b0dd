// Displays a picture: exposure, the filmic curve of image/png.h, and sRGB.

uniform highp sampler2D picture; // linear, top row first
uniform vec4 viewport; // x, y from the lower left corner, width, height
uniform float exposure; // stops

out vec4 colour;

void main() {
  vec2 place = (gl_FragCoord.xy - viewport.xy) / viewport.zw;
  vec2 size = vec2(textureSize(picture, 0));
  ivec2 texel = ivec2(vec2(place.x, 1.0 - place.y) * size);
  vec3 x = max(texelFetch(picture, texel, 0).rgb * exp2(exposure), 0.0);
  vec3 y = min(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 1.0);
  vec3 curve = 1.055 * pow(y, vec3(1.0 / 2.4)) - 0.055;
  colour = vec4(mix(curve, 12.92 * y, lessThanEqual(y, vec3(0.0031308))), 1.0);
}
