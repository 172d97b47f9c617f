// One field in the plane: colours between its levels, the levels as thin lines, omega = 0 as a heavy one.
uniform vec2 middle, reach;  // of the picture in the plane; half its width and height
uniform ivec2 size;
uniform float levels[MOST], dots;
uniform vec3 colours[MOST];  // below the first level, between levels; beyond the last
uniform int count;
uniform vec3 paper;
out vec4 colour;

void main() {
  vec2 p = middle + (gl_FragCoord.xy / vec2(size) * 2.0 - 1.0) * reach;
  float v = field(p), omega = value(p);
  // A line is as wide on the screen whatever the slope: the distance to a level over that of neighbouring pixels.
  float steep = max(length(vec2(dFdx(v), dFdy(v))), 1e-30), rise = max(length(vec2(dFdx(omega), dFdy(omega))), 1e-30);
  vec3 c = colours[0];
  float nearest = 1e9;
  for (int k = 0; k < MOST - 1; k++) {
    if (k >= count) break;
    if (v >= levels[k]) c = colours[k + 1];
    nearest = min(nearest, abs(v - levels[k]) / steep);
  }
  if (!(v == v)) c = mod(gl_FragCoord.x + gl_FragCoord.y, 8.0 * dots) < 1.6 * dots ? vec3(0.3) : vec3(0.8);
  else c *= 1.0 - 0.55 * clamp(0.35 * dots + 0.5 - nearest, 0.0, 1.0);
  c *= 1.0 - clamp(1.1 * dots + 0.5 - abs(omega) / rise, 0.0, 1.0);
  colour = vec4(c, 1);
}
