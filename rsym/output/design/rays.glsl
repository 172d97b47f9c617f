const float NOTHING = -1.0, SECTION = -2.0, UNDECIDED = -3.0, WALL = -4.0;  // no leaf; walls of x, y, z: -4, -5, -6
uniform mat3 turn;           // from the camera (right, up, towards the eye) to the body
uniform vec3 eye;
uniform vec4 lens;           // half the width and the height of the picture at distance 1; its shift
uniform vec2 jitter;
uniform float pixel, stride; // width of a pixel at distance 1; pixels from one fragment to the next
uniform ivec2 size;          // of the picture in pixels

vec3 direction(vec2 fragment) {
  vec2 at = (fragment * stride + jitter) / vec2(size) * 2.0 - 1.0;
  return normalize(turn * vec3((at - lens.zw) * lens.xy, -1));
}
