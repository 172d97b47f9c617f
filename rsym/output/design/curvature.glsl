// Mean and Gaussian curvature of the leaf at each hit, positive where the body is convex.
uniform sampler2D hits, surfaces;
out vec4 curvature;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 hit = texelFetch(hits, here, 0), surface = texelFetch(surfaces, here, 0);
  curvature = vec4(0);
  if (hit.x < 0.0 || hit.y < 0.0) return;
  vec3 g, a, b;                // the gradient; xx, xy, xz; yy, yz, zz
  second(int(hit.y), eye + direction(gl_FragCoord.xy) * surface.w, g, a, b);
  float size = length(g);
  vec3 n = g / size;
  mat3 H = mat3(a.x, a.y, a.z, a.y, b.x, b.y, a.z, b.y, b.z);
  mat3 A = mat3(cross(H[1], H[2]), cross(H[2], H[0]), cross(H[0], H[1]));  // the adjugate of a symmetric matrix
  float mean = -(a.x + b.x + b.z - dot(n, H * n)) / (2.0 * size), gauss = dot(n, A * n) / (size * size);
  curvature = vec4(mean, gauss, mean + sqrt(max(mean * mean - gauss, 0.0)), 0);
}
