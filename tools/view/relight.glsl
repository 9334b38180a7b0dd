// The picture that a light makes through the transfer of each pixel: the inner product of their
// coefficients, as transfer_packing.h lays them out.

uniform highp usampler2D transfer, light_differences, firsts;
uniform highp sampler2D pixels, surroundings;
uniform vec3 light_mean;
uniform int squares_end; // squares from here on are finer than what is asked for

out vec4 colour;

const int row_bits = 11;

ivec2 place_of(int i) { return ivec2(i & ((1 << row_bits) - 1), i >> row_bits); }

vec3 difference(uint packed_rgb) {
  int bits = int(packed_rgb);
  return vec3((bits << 22) >> 22, (bits << 12) >> 22, (bits << 2) >> 22);
}

void main() {
  ivec2 film = ivec2(gl_FragCoord.xy);
  vec4 pixel = texelFetch(pixels, film, 0);
  if (pixel.a < 0.0) {
    colour = vec4(texelFetch(surroundings, film, 0).rgb, 0.0);
    return;
  }
  int node = int(texelFetch(firsts, film, 0).r);
  int end = node + int(pixel.a);
  vec3 sum = pixel.rgb * light_mean;
  accesses = 2.0;
  for (; node < end; ++node) {
    uvec4 t = texelFetch(transfer, place_of(node), 0);
    int square = int(t.a >> 8);
    accesses += 1.0;
    if (square >= squares_end)
      break;
    uvec4 light = texelFetch(light_differences, place_of(square), 0);
    accesses += 1.0;
    float unit = uintBitsToFloat((t.a & 255u) << 23) * uintBitsToFloat(light.a);
    sum += unit * (difference(t.r) * difference(light.r) + difference(t.g) * difference(light.g) +
                   difference(t.b) * difference(light.b));
  }
  colour = vec4(max(sum, 0.0) * (4.0 * pi), accesses);
}
