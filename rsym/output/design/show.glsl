// The mean of the samples, as a screen shows it.
uniform sampler2D sums;
uniform float count;
uniform vec2 window;
out vec4 colour;

void main() {
  vec3 light = clamp(texture(sums, gl_FragCoord.xy / window).rgb / count, 0.0, 1.0);
  colour = vec4(mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light)), 1);
}
