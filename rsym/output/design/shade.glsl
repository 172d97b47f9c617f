// Light, colours, hatching and lines. The light is that of printed pictures: see shade() in rsym/output/shading.py.
uniform sampler2D hits, surfaces, curvatures, paints;
uniform int colouring;       // 0 parts, 1 zebra, 2 mean, 3 Gaussian, 4 greater curvature, 5 normals
uniform float scale;         // the length that curvatures are measured by
uniform vec4 cut;
uniform vec3 key, fill, inside, ink, paper;
uniform float keyStrength, fillStrength, ambient, sky, rim, shine, shineExponent, dots;
out vec4 colour;

const float SMOOTH = 0.985;  // leaves that meet at less than 10 degrees show no edge

vec3 lit(vec3 c, vec3 n) {
  n = normalize(vec3(n.xy, max(n.z, 0.0)));
  float wrapped = pow(max((dot(n, key) + 0.35) / 1.35, 0.0), 1.5);
  float filled = pow(0.5 + 0.5 * dot(n, fill), 2.0);
  float diffuse = keyStrength * wrapped + fillStrength * filled + ambient + sky * n.y;
  diffuse *= 1.0 - rim * (1.0 - n.z) * (1.0 - n.z);
  return c * diffuse + shine * pow(max(dot(n, normalize(key + vec3(0, 0, 1))), 0.0), shineExponent);
}

vec3 diverging(float x) {
  x = clamp(x, -1.0, 1.0);
  return mix(vec3(0.72), x > 0.0 ? vec3(0.45, 0.01, 0.02) : vec3(0.04, 0.07, 0.53), abs(x));
}

vec3 normal(vec4 hit, vec4 surface, vec3 d) {
  if (hit.y == SECTION) return cut.xyz;
  if (hit.y > WALL) return surface.xyz;
  vec3 n = vec3(0);
  int axis = int(WALL - hit.y + 0.5);
  n[axis] = -sign(d[axis]);
  return n;
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 hit = texelFetch(hits, here, 0), surface = texelFetch(surfaces, here, 0);
  vec3 d = direction(gl_FragCoord.xy);
  colour = vec4(paper, 1);
  if (hit.x < 0.0) return;
  vec3 n = normal(hit, surface, d), seen = n * turn;
  bool leaf = hit.y >= 0.0;
  vec3 c = leaf ? texelFetch(paints, ivec2(int(hit.y), 0), 0).rgb : inside;
  bool stripe = mod(gl_FragCoord.x + gl_FragCoord.y, 8.0 * dots) < 1.6 * dots;
  if (hit.y == SECTION && stripe) c *= 0.55;
  if (hit.y == UNDECIDED) c = mod(floor(gl_FragCoord.x / 3.0) + floor(gl_FragCoord.y / 3.0), 2.0) < 1.0 ? vec3(1, 0, 1) : vec3(0);
  else if (leaf && colouring == 1) {
    float z = sin(26.0 * dot(reflect(d, n) * turn, vec3(0.2, 1.0, 0.1))), w = fwidth(z);
    c = vec3(mix(0.03, 0.9, smoothstep(-w, w, z)));
  } else if (leaf && colouring > 1 && colouring < 5) {
    vec4 k = texelFetch(curvatures, here, 0);
    c = diverging(colouring == 2 ? k.x * scale : colouring == 3 ? k.y * scale * scale : k.z * scale);
  }
  if (hit.y != UNDECIDED) c = leaf && colouring == 5 ? pow(0.5 + 0.5 * n, vec3(2.2)) : lit(c, seen);
  // Lines where leaves meet at an angle, and where what lies behind is far.
  float line = 0.0, far = pixel * hit.x;
  for (int i = 0; i < 4; i++) {
    ivec2 there = here + ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0);
    if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, size))) continue;
    vec4 other = texelFetch(hits, there, 0);
    if (other.x < 0.0) {
      line = 1.0;
      continue;
    }
    vec4 beside = texelFetch(surfaces, there, 0);
    if (other.y != hit.y && dot(normal(other, beside, d), n) < SMOOTH) line = max(line, 0.8);
    float behind = (beside.w - surface.w) * abs(dot(n, d));
    if (behind > 6.0 * far && beside.w - surface.w > 0.004 * hit.x) line = 1.0;
  }
  colour.rgb = mix(c, ink, line);
}
