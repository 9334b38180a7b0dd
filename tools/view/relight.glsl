// Relighting: the inner product of the coefficients of each pixel's transfer with those of a light.
// transfer.h describes the textures.

uniform highp usampler2D transfer, light_differences, firsts;
uniform highp sampler2D pixels, background;
uniform vec3 light_mean;
uniform int squares_end; // squares from this number on are finer than the level that is drawn

out vec4 colour;

const int row_bits = 11;

ivec2 texel_of(int i) { return ivec2(i & ((1 << row_bits) - 1), i >> row_bits); }

vec3 unpack_rgb(uint packed_rgb) {
  int bits = int(packed_rgb);
  return vec3((bits << 22) >> 22, (bits << 12) >> 22, (bits << 2) >> 22);
}

void main() {
  ivec2 film = ivec2(gl_FragCoord.xy);
  vec4 pixel = texelFetch(pixels, film, 0);
  if (pixel.a < 0.0) {
    colour = vec4(texelFetch(background, film, 0).rgb, 0.0);
    return;
  }
  int node = int(texelFetch(firsts, film, 0).r);
  int end = node + int(pixel.a);
  vec3 sum = pixel.rgb * light_mean;
  accesses = 2.0;
  for (; node < end; ++node) {
    uvec4 t = texelFetch(transfer, texel_of(node), 0);
    int square = int(t.a >> 8);
    accesses += 1.0;
    if (square >= squares_end)
      break;
    uvec4 light = texelFetch(light_differences, texel_of(square), 0);
    accesses += 1.0;
    float unit = uintBitsToFloat((t.a & 255u) << 23) * uintBitsToFloat(light.a);
    sum += unit * (unpack_rgb(t.r) * unpack_rgb(light.r) + unpack_rgb(t.g) * unpack_rgb(light.g) +
                   unpack_rgb(t.b) * unpack_rgb(light.b));
  }
  colour = vec4(max(sum, 0.0) * (4.0 * pi), accesses);
}
