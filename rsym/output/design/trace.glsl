// Casts a beam for each square of pixels, or a ray for each pixel. `form` and `model` are each called at one place of
// the text, for compilers write functions out where they are called.
uniform vec3 low, high;
uniform vec4 cut;            // what has cut.xyz . p > cut.w is cut away
uniform float spread;        // how far a ray of the beam may be from its middle, at distance 1; 0 for a ray
uniform int tile, limit;     // pixels along a square whose beam is known, or 0; steps
uniform sampler2D beams;
out vec4 found;              // distance, leaf or a code, steps

// The march is that of rsym/sampling/kernels/march_code.py; CROSSING, SHORTEST and PATIENCE are those of a page in ray_steps.py.

// The smallest w >= 0 at which end + linear (w - 1) + quadratic ((w - 1)^2 - 1) is 0; beyond 2 if there is none.
float first_root(float end, float linear, float quadratic) {
  float slope = linear - 2.0 * quadratic, square = slope * slope - 4.0 * quadratic * end, root = sqrt(max(square, 0.0));
  float near = -2.0 * end / max(slope + root, 1e-30), far = (root - slope) / max(2.0 * quadratic, 1e-30);
  float found = mix(mix(3.0, far, quadratic > 0.0), near, slope >= 0.0);
  return mix(0.0, mix(3.0, found, square >= 0.0), end < 0.0);
}

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
  float from = t, step = 0.5 * (end - t), failed = 0.0;
  for (int i = 0; t < end; i++) {
    found.z = float(i);
    if (i == limit) {
      found.xy = vec2(t, spread > 0.0 ? NOTHING : UNDECIDED);
      return;
    }
    step = min(step, end - t);
    float k = 0.5 * step, e = spread * (t + step), size = pixel * t;
    vec3 p = eye + d * (t + k);
    vec4 v = model(vec4(p.x - e, p.x + e, d.x * k, 0), vec4(p.y - e, p.y + e, d.y * k, 0), vec4(p.z - e, p.z + e, d.z * k, 0));
    // Before the first root of the upper bound there is nothing, behind that of the lower one the body.
    float bend = v.w - v.z;
    float upper = first_root(v.y + bend, v.z, v.w), lower = first_root(v.x + bend, v.z, v.w);
    float begin = t + upper * k, width = max((lower - upper) * k, 0.0);
    if (upper > 2.0) {
      t += step;
      step *= 2.0;
      continue;
    }
    if (spread > 0.0) {
      if (step < size) {
        found.x = begin;
        return;
      }
      t = begin;
      step = k;
      continue;
    }
    float shortest = size * SHORTEST * exp2(clamp(round(failed / PATIENCE - 0.5), 0.0, 60.0));
    bool small = step <= 1.01 * shortest, crosses = lower <= 2.0 && (small || width < CROSSING * size);
    if (crosses || small) {
      float at = crosses ? begin + width : t + step;
      vec2 f = form(eye + d * at);
      // Enclosures know better than a value whose sign is rounded.
      if (f.x + (crosses ? 0.01 * size : 0.0) > 0.0) {
        found.xy = begin <= from && start != NOTHING ? vec2(from, start) : vec2(at, f.y);
        return;
      }
      failed += 1.0;
      t = max(at, begin + shortest);
      step = shortest;
    } else {
      step = max(min(lower <= 2.0 ? width : t + step - begin, k), shortest);
      t = begin;
    }
  }
}
