// The place of each hit to the last digit, by Newton on the leaf that is active there, and the normal of that leaf.
uniform sampler2D hits;
uniform int rounds;          // a number of the program, or compilers would write the loop out
out vec4 surface;            // normal, distance

void main() {
  vec4 hit = texelFetch(hits, ivec2(gl_FragCoord.xy), 0);
  vec3 d = direction(gl_FragCoord.xy), n = -d;
  float t = hit.x;
  if (hit.x >= 0.0 && hit.y >= 0.0) {
    for (int i = 0; i < rounds; i++) {
      vec4 g = leaf(int(hit.y), eye + d * t);
      n = -normalize(g.yzw);
      float step = -g.x / dot(g.yzw, d);
      if (i + 1 < rounds && abs(step) < pixel * t) t += step;
    }
    if (!(dot(n, n) > 0.5)) n = -d;  // a corner of the leaf, where it has none
  }
  surface = vec4(n, t);
}
