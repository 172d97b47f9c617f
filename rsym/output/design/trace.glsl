// Casts a beam for each square of pixels, or a ray for each pixel. `form` and `model` are each called at one place of
// the text, for compilers write functions out where they are called.
uniform vec3 low, high;
uniform vec4 cut;            // what has cut.xyz . p > cut.w is cut away
uniform float spread;        // how far a ray of the beam may be from its middle, at distance 1; 0 for a ray
uniform int tile, limit;     // pixels along a square whose beam is known, or 0; steps
uniform sampler2D beams;
out vec4 found;              // distance, leaf or a code, steps

const float THIN = 0.1;      // of a pixel: shorter pieces are taken for points

void main() {
  vec3 d = direction(gl_FragCoord.xy);
  vec3 margin = vec3(spread * 4.0 * length(high - low));
  vec3 first = (low - margin - eye) / d, second = (high + margin - eye) / d;
  vec3 entries = min(first, second), exits = max(first, second);
  float t = max(max(entries.x, entries.y), max(entries.z, 0.0)), end = min(min(exits.x, exits.y), exits.z);
  // A body that reaches beyond its bounds ends there, flat.
  float start = t > 0.0 ? WALL - (t == entries.x ? 0.0 : t == entries.y ? 1.0 : 2.0) : SECTION;
  float slope = dot(cut.xyz, d), room = cut.w - dot(cut.xyz, eye);
  if (spread == 0.0) {
    float reach = room / slope;
    if (abs(slope) < 1e-9) end = room < 0.0 ? -1.0 : end;
    else if (slope > 0.0) end = min(end, reach);
    else if (reach > t) { t = reach; start = SECTION; }
  }
  found = vec4(-1.0, NOTHING, 0.0, 0.0);
  if (tile > 0) {
    float known = texelFetch(beams, ivec2(gl_FragCoord.xy) / tile, 0).x;
    if (known < 0.0) return;
    if (known > t) { t = known; start = NOTHING; }
  }
  float h = 0.5 * (end - t);
  for (int i = 0; t < end; i++) {
    found.z = float(i);
    if (i == limit) {
      found.xy = vec2(t, spread > 0.0 ? NOTHING : UNDECIDED);
      return;
    }
    float small = pixel * t, probe = -1.0;
    bool thin = false;
    if (i == 0 && spread == 0.0) probe = t;
    else {
      h = min(h, end - t);
      float k = 0.5 * h, e = spread * (t + h);
      vec3 p = eye + d * (t + k);
      vec4 v = model(vec4(p.x - e, p.x + e, d.x * k, 0), vec4(p.y - e, p.y + e, d.y * k, 0), vec4(p.z - e, p.z + e, d.z * k, 0));
      if (highest(v) < 0.0) {
        t += h;
        h *= 2.0;
        continue;
      }
      if (spread > 0.0) {
        if (h < small) {
          found.x = t;
          return;
        }
        h *= 0.5;
        continue;
      }
      // Where the upper bound v.y + v.z s + v.w s^2 is negative there is nothing: on to its first root.
      if (v.y - v.z + v.w < 0.0) {
        float root = sqrt(max(v.z * v.z - 4.0 * v.w * v.y, 0.0)), w = -0.5 * (v.z + (v.z < 0.0 ? -root : root));
        float one = v.w != 0.0 ? w / v.w : 2.0, other = w != 0.0 ? v.y / w : 2.0;
        float s = min(one >= -1.0 ? one : 2.0, other >= -1.0 ? other : 2.0);
        if (s > 1.0) {
          t += h;
          h *= 2.0;
          continue;
        }
        float step = clamp((s + 1.0) * k, 0.0, h), rise = v.z + 2.0 * v.w * s;
        float gap = (v.y - v.x) / max(abs(rise), 1e-20) * k;
        t += max(step - 0.01 * small, 0.0);
        h -= step;
        if (rise > 0.0 && gap < 0.25 * small) probe = t + 0.25 * small + gap;
      }
      if (probe < 0.0 && h < small * THIN) {
        probe = t + small * THIN;
        thin = true;
      }
    }
    if (probe >= 0.0) {
      vec2 f = form(eye + d * probe);
      if (f.x > 0.0) {
        found.xy = vec2(probe, i == 0 && start != NOTHING ? start : f.y);
        return;
      }
      if (i == 0) continue;
      if (thin) {
        t = probe;
        h = small;
        continue;
      }
    }
    h = max(0.5 * h, 0.9 * small * THIN);
  }
}
