// A shape in the plane: one field by the graphics processor, the curvature comb and the points by JavaScript, float64.
const GRID = 160, TEETH = 400;

const picture = (() => {
  const low = data.bounds.map(side => side[0]), high = data.bounds.map(side => side[1]);
  const middle = low.map((end, k) => (end + high[k]) / 2);
  const diagonal = Math.hypot(...low.map((end, k) => high[k] - end));
  const fields = {
    field: {value: 0, low: 0, high: data.fields.length - 1, whole: true},
    comb: {value: 1, low: 0, high: 1, whole: true},
    zoom: {value: 1, low: 0.1, high: 1e4},
    x: {value: middle[0], low: -1e12, high: 1e12},
    y: {value: middle[1], low: -1e12, high: 1e12},
  };
  const run = scheduler(), linked = [];
  let gl, canvas, overlay, uniforms, broken = false, asked = false;

  function frame() {
    const [wide, tall] = sized(canvas);
    const scale = view.zoom * Math.min(wide / (high[0] - low[0]), tall / (high[1] - low[1]));
    return {wide, tall, scale};
  }

  // The programs of fields are compiled when they are first asked for.
  function ready(k) {
    if (linked[k]) return linked[k].done;
    const one = linked[k] = {done: null};
    say(`Compiling ${data.fields[k].name} ...`);
    const found = program(gl, source(`field-${k}`));
    whenLinked([found], () => {
      one.done = found;
      say("");
      byId("still").hidden = true;
      canvas.hidden = overlay.hidden = false;
      change(false);
    }, error => {
      broken = true;
      stand(`The picture cannot be drawn here: ${error.message.slice(0, 300)}.`);
    });
    return null;
  }

  function* draw() {
    const found = ready(view.field);
    if (!found || broken) return;
    const {wide, tall, scale} = frame(), field = data.fields[view.field];
    for (const one of [canvas, overlay]) if (one.width !== wide || one.height !== tall) [one.width, one.height] = [wide, tall];
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, wide, tall);
    found.use({
      u: uniforms[view.field](), middle: [view.x, view.y], reach: [wide / 2 / scale, tall / 2 / scale], size: [wide, tall],
      dots: devicePixelRatio, count: field.levels.length, levels: field.levels, colours: field.colours.flat(),
    });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const pen = overlay.getContext("2d");
    pen.clearRect(0, 0, wide, tall);
    if (view.comb) comb(pen, wide, tall, scale);
    canvas.dataset.pictures = 1 + Number(canvas.dataset.pictures || 0);
    canvas.dataset.samples = 1;
    yield;
  }

  // Where omega changes its sign along the edges of a grid, moved onto it by Newton: pieces of omega = 0.
  function boundary(omega) {
    const step = low.map((end, k) => (high[k] - end) / GRID), one = new Float64Array(4), pieces = [];
    const signs = new Float64Array((GRID + 1) ** 2), at = (i, j) => signs[i * (GRID + 1) + j];
    const place = (i, j) => [low[0] + (i + 0.381966) * step[0], low[1] + (j + 0.414214) * step[1]];
    for (let i = 0; i <= GRID; i++) for (let j = 0; j <= GRID; j++) {
      omega(...place(i, j), one);
      signs[i * (GRID + 1) + j] = one[0];
    }
    const between = (i, j, k, l) => {
      const [a, b] = [place(i, j), place(k, l)], [u, v] = [at(i, j), at(k, l)];
      let [from, to] = u > 0 ? [b, a] : [a, b];
      let best = from.map((end, n) => end + (to[n] - end) * Math.abs(u > 0 ? v : u) / Math.abs(u - v));
      for (let n = 0; n < 6; n++) {
        omega(...best, one);
        [from, to] = one[0] > 0 ? [from, best] : [best, to];
        best = from.map((end, m) => (end + to[m]) / 2);
      }
      for (let n = 0; n < 3; n++) {
        omega(...best, one);
        const size = one[1] ** 2 + one[2] ** 2, next = [best[0] - one[0] * one[1] / size, best[1] - one[0] * one[2] / size];
        if (!(Math.hypot(next[0] - best[0], next[1] - best[1]) < step[0] + step[1])) break;
        best = next;
      }
      return best;
    };
    for (let i = 0; i < GRID; i++) for (let j = 0; j < GRID; j++) {
      const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]], crossed = [];
      corners.forEach((corner, k) => {
        const next = corners[(k + 1) % 4], [u, v] = [at(...corner), at(...next)];
        if (u > 0 !== v > 0 && Number.isFinite(u) && Number.isFinite(v)) crossed.push(between(...corner, ...next));
      });
      for (let k = 0; k + 1 < crossed.length; k += 2) pieces.push([crossed[k], crossed[k + 1]]);
    }
    return pieces;
  }

  // Teeth normal to omega = 0, as long as the curvature, outwards where the inside is convex.
  function comb(pen, wide, tall, scale) {
    const omega = formulas.curve(values), one = new Float64Array(4), teeth = [];
    const pieces = boundary(omega), every = Math.max(1, Math.ceil(pieces.length / TEETH));
    pieces.forEach(([from, to], k) => {
      if (k % every) return;
      const at = [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2];
      for (let n = 0; n < 3; n++) {
        omega(...at, one);
        const size = one[1] ** 2 + one[2] ** 2;
        if (n < 2 && size > 0) [at[0], at[1]] = [at[0] - one[0] * one[1] / size, at[1] - one[0] * one[2] / size];
      }
      const size = Math.hypot(one[1], one[2]);
      if (Number.isFinite(one[3]) && size > 0) teeth.push({at, out: [-one[1] / size, -one[2] / size], bend: one[3]});
    });
    design.teeth = teeth;
    const sizes = teeth.map(tooth => Math.abs(tooth.bend)).sort((a, b) => a - b);
    const usual = sizes[Math.floor(0.95 * (sizes.length - 1))] || 1, length = 0.1 * diagonal / usual;
    const put = ([x, y]) => [wide / 2 + (x - view.x) * scale, tall / 2 - (y - view.y) * scale];
    pen.lineWidth = devicePixelRatio;
    for (const sign of [1, -1]) {
      pen.strokeStyle = sign > 0 ? "#b30326" : "#2a3f9e";
      pen.beginPath();
      for (const {at, out, bend} of teeth) {
        if (bend * sign <= 0) continue;
        const end = clamped(bend * length, -0.25 * diagonal, 0.25 * diagonal);
        pen.moveTo(...put(at));
        pen.lineTo(...put([at[0] + out[0] * end, at[1] + out[1] * end]));
      }
      pen.stroke();
    }
  }

  function change(moving) {
    if (gl && !broken) run(draw());
  }

  const placeOf = ([across, up]) => {
    const {wide, tall, scale} = frame();
    return [view.x + (across - 0.5) * wide / scale, view.y + (up - 0.5) * tall / scale];
  };

  function pick(at) {
    const place = placeOf(at), one = new Float64Array(4);
    formulas.curve(values)(...place, one);
    return {part: data.leaves[formulas.leaves(values)(...place)], place, value: one[0]};
  }

  function point(at) {
    const found = at && pick(at);
    byId("tip").textContent = found
      ? `${found.part}: ${found.place.map((end, k) => `${data.coordinates[k]} ${end.toPrecision(5)}`).join(", ")}; \u03c9 ${found.value.toPrecision(4)}`
      : "";
  }

  function zoom(factor, at) {
    const before = placeOf(at), next = clamped(view.zoom * factor, fields.zoom.low, fields.zoom.high);
    const by = view.zoom / next;
    window.change({zoom: next, x: before[0] + (view.x - before[0]) * by, y: before[1] + (view.y - before[1]) * by}, true);
  }

  function begin() {
    gl = context(canvas);
    if (!gl) {
      broken = true;
      stand(NEEDED);
      return;
    }
    broken = false;
    linked.length = 0;
    uniforms = formulas.fields.map(uploaded);
    change(false);
  }

  function start() {
    canvas = sheet();
    overlay = made("canvas", {id: "overlay"});
    byId("stage").append(overlay);
    canvas.hidden = overlay.hidden = true;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${data.title}: arrow keys move the plane, plus and minus zoom`);
    const move = (x, y) => {
      const {scale} = frame();
      window.change({x: view.x - x * devicePixelRatio / scale, y: view.y + y * devicePixelRatio / scale}, true);
    };
    const reset = () => window.change({zoom: 1, x: middle[0], y: middle[1]});
    listen(canvas, {drag: move, move, zoom, point, reset, press: at => choose(pick(at).part)});
    canvas.addEventListener("webglcontextlost", event => {
      event.preventDefault();
      broken = true;
      stand("The graphics processor was lost.");
    });
    canvas.addEventListener("webglcontextrestored", begin);
    begin();
  }

  function save(done) {
    const copy = made("canvas", {width: canvas.width, height: canvas.height}), pen = copy.getContext("2d");
    if (broken || canvas.hidden) pen.drawImage(byId("still"), 0, 0);
    else for (const one of [canvas, overlay]) pen.drawImage(one, 0, 0);
    copy.toBlob(done);
  }

  const controls = () => [choice("field", "Show", data.fields.map(one => one.title)), choice("comb", "Curvature comb", ["none", "shown"])];
  return {fields, controls, start, change, save};
})();
