// A body: beams of 8 x 8 pixels, a ray for each pixel, the surface where it is hit, light; then samples of each pixel.
const TILE = 8, LIMIT = 400, ROUNDS = 4, DISTANCE = 5;
const COLOURINGS = ["parts", "zebra", "mean curvature", "Gaussian curvature", "greater curvature", "normals"];
const AXES = ["none", ...data.coordinates];
const EYES = {front: [90, 0], rear: [-90, 0], left: [180, 0], right: [0, 0], top: [-90, 90], bottom: [-90, -90]};

const picture = (() => {
  const low = data.bounds.map(side => side[0]), high = data.bounds.map(side => side[1]);
  const {middle, radius, extent} = data;
  const turns = Math.PI;
  const fields = {
    azimuth: {value: data.azimuth, low: -1000, high: 1000},
    elevation: {value: data.elevation, low: -turns / 2, high: turns / 2},
    zoom: {value: 1, low: 0.1, high: 100},
    x: {value: 0, low: -100, high: 100},
    y: {value: 0, low: -100, high: 100},
    colours: {value: 0, low: 0, high: COLOURINGS.length - 1, whole: true},
    section: {value: 0, low: 0, high: 3, whole: true},
    at: {value: 0, low: -1e9, high: 1e9},
  };
  const run = scheduler();
  let gl, canvas, programs, curvature, letterUniforms, paints;
  let sets = {}, shown = null, share = 0.5, settling = 0, broken = false;

  function camera(wide, tall) {
    const [sinE, cosE] = [Math.sin(view.elevation), Math.cos(view.elevation)];
    const [sinA, cosA] = [Math.sin(view.azimuth), Math.cos(view.azimuth)];
    const back = [cosE * cosA, cosE * sinA, sinE];
    const fit = view.zoom * Math.min(wide / extent[0], tall / extent[1]);
    return {
      turn: [-sinA, cosA, 0, -sinE * cosA, -sinE * sinA, cosE, ...back],
      eye: middle.map((place, k) => place + back[k] * DISTANCE * radius),
      lens: [wide / fit, tall / fit, view.x, view.y],
      pixel: 2 / fit,
    };
  }

  // What lies on the eye's side of the section is cut away.
  function cut(eye) {
    const plane = [0, 0, 0, 1];
    if (view.section) {
      const k = view.section - 1, side = eye[k] > view.at ? 1 : -1;
      plane[k] = side;
      plane[3] = side * view.at;
    }
    return plane;
  }

  function buffers(name, wide, tall) {
    const old = sets[name];
    if (old && old.wide === wide && old.tall === tall) return old;
    if (old) for (const one of Object.values(old)) one.free?.();
    const exact = () => target(gl, wide, tall, gl.RGBA32F);
    return sets[name] = {
      wide, tall,
      beams: target(gl, Math.ceil(wide / TILE), Math.ceil(tall / TILE), gl.RGBA32F),
      hits: exact(), surfaces: exact(), curvatures: exact(),
      sums: target(gl, wide, tall, gl.RGBA16F, gl.LINEAR),
    };
  }

  const halton = (k, base) => {
    let result = 0;
    for (let share = 1 / base; k > 0; k = Math.floor(k / base), share /= base) result += share * (k % base);
    return result;
  };

  function wait() {  // until the graphics processor is done: what comes next may be put off
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, new Float32Array(4));
  }

  function* samples(name, part, most) {
    const [wide, tall] = sized(canvas, part), set = buffers(name, wide, tall), seen = camera(wide, tall);
    const u = letterUniforms(), plane = cut(seen.eye), step = Math.max(TILE, Math.ceil(tall / 8));
    const rays = {...seen, u, size: [wide, tall], stride: 1, jitter: [0, 0], low, high, cut: plane};
    const curved = view.colours >= 2 && view.colours <= 4;
    gl.disable(gl.BLEND);
    programs.trace.use({
      ...rays, stride: TILE, spread: seen.pixel * (TILE * 0.7072 + 0.75), pixel: seen.pixel * TILE,
      tile: 0, limit: LIMIT,
    }, {beams: paints});
    fill(gl, set.beams, 0, set.beams.tall);
    for (let k = 0; k < most; k++) {
      rays.jitter = k ? [halton(k, 2) - 0.5, halton(k, 3) - 0.5] : [0, 0];
      for (let row = 0; row < tall; row += step) {
        const end = Math.min(row + step, tall);
        gl.disable(gl.BLEND);
        programs.trace.use({...rays, spread: 0, tile: TILE, limit: LIMIT}, {beams: set.beams.texture});
        fill(gl, set.hits, row, end);
        programs.surface.use({...rays, rounds: ROUNDS}, {hits: set.hits.texture});
        fill(gl, set.surfaces, row, end);
        if (curved) {
          curvature.use(rays, {hits: set.hits.texture, surfaces: set.surfaces.texture});
          fill(gl, set.curvatures, row, end);
        }
        wait();
        if (part === 1) yield;
      }
      const textures = {hits: set.hits, surfaces: set.surfaces, curvatures: set.curvatures};
      for (const one of Object.keys(textures)) textures[one] = textures[one].texture;
      programs.shade.use({
        ...rays, ...data.light, paper: linear(getComputedStyle(document.body).backgroundColor), dots: devicePixelRatio * part,
        colouring: view.colours, scale: radius * 0.35,
      }, {...textures, paints});
      if (k) gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE);
      fill(gl, set.sums, 0, tall);
      gl.disable(gl.BLEND);
      const [width, height] = sized(canvas);
      if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
      programs.show.use({count: k + 1, window: [width, height]}, {sums: set.sums.texture});
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.viewport(0, 0, width, height);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      shown = {...set, seen, name};
      canvas.dataset.pictures = 1 + Number(canvas.dataset.pictures || 0);
      canvas.dataset.samples = name === "still" ? k + 1 : 0;
      yield;
    }
  }

  // While something moves the picture is as coarse as it must be to follow.
  function* moving() {
    const begun = performance.now();
    yield* samples("moving", share, 1);
    const taken = performance.now() - begun;
    share = clamped(share * Math.sqrt(60 / Math.max(taken, 1)), 0.12, 1);
  }

  function change(moves) {
    clearTimeout(settling);
    byId("legend").hidden = view.colours > 0;
    if (!programs || broken) return;
    if (view.colours >= 2 && view.colours <= 4 && !curvature) {
      needCurvature();
      return;
    }
    if (!moves) run(samples("still", 1, design.samples));
    else {
      run(moving());
      settling = setTimeout(() => change(false), 250);
    }
  }

  function needCurvature() {
    say("Compiling the second derivatives ...");
    const found = program(gl, source("curvature"));
    curvature = null;
    whenLinked([found], () => {
      curvature = found;
      say("");
      change(false);
    }, failed);
  }

  // The leaf or code, the distance and the place at a point of the canvas.
  function pick([across, up]) {
    if (!shown || broken) return null;
    const {wide, tall, hits, surfaces, seen} = shown, one = new Float32Array(4), two = new Float32Array(4);
    const column = clamped(Math.floor(across * wide), 0, wide - 1), row = clamped(Math.floor(up * tall), 0, tall - 1);
    for (const [from, to] of [[hits, one], [surfaces, two]]) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, from.frame);
      gl.readPixels(column, row, 1, 1, gl.RGBA, gl.FLOAT, to);
    }
    if (one[0] < 0) return null;
    const x = ((column + 0.5) / wide * 2 - 1 - seen.lens[2]) * seen.lens[0], y = ((row + 0.5) / tall * 2 - 1 - seen.lens[3]) * seen.lens[1];
    const d = [0, 1, 2].map(k => seen.turn[k] * x + seen.turn[3 + k] * y - seen.turn[6 + k]), size = Math.hypot(...d);
    return {leaf: one[1], part: one[1] >= 0 ? data.leaves[one[1]] : null, place: seen.eye.map((end, k) => end + d[k] / size * two[3])};
  }

  function point(at) {
    const found = at && pick(at);
    if (!found) {
      byId("tip").textContent = "";
      return;
    }
    const what = found.part ?? (found.leaf === -2 ? "section" : found.leaf === -3 ? "undecided" : "end of the bounds");
    byId("tip").textContent = `${what}: ${found.place.map((end, k) => `${data.coordinates[k]} ${end.toPrecision(5)}`).join(", ")}`;
  }

  function zoom(factor, [across, up]) {
    const next = clamped(view.zoom * factor, fields.zoom.low, fields.zoom.high), by = next / view.zoom;
    const x = 2 * across - 1, y = 2 * up - 1;
    change_({zoom: next, x: x + (view.x - x) * by, y: y + (view.y - y) * by});
  }

  const change_ = parts => window.change(parts, true);

  function failed(error) {
    broken = true;
    stand(`The picture cannot be drawn here: ${error.message.slice(0, 300)}.`);
  }

  function begin() {
    gl = context(canvas);
    if (!gl) {
      broken = true;
      stand(NEEDED);
      return;
    }
    sets = {};
    shown = programs = curvature = null;
    const found = Object.fromEntries(["trace", "surface", "shade", "show"].map(name => [name, program(gl, source(name))]));
    letterUniforms = uploaded(formulas.letters);
    paints = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, paints);
    const colours = data.leaves.flatMap(name => [...data.parts[name].paint, 1]);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, data.leaves.length, 1, 0, gl.RGBA, gl.FLOAT, new Float32Array(colours));
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    whenLinked(Object.values(found), () => {
      if (gl.isContextLost()) return;
      programs = found;
      broken = false;
      say("");
      byId("still").hidden = true;
      canvas.hidden = false;
      change(false);
    }, failed);
  }

  function start() {
    canvas = sheet();
    canvas.hidden = true;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${data.title}: arrow keys turn the body, with shift they move it, plus and minus zoom`);
    listen(canvas, {
      drag: (x, y) => change_({azimuth: view.azimuth - x / 150, elevation: clamped(view.elevation + y / 150, -turns / 2, turns / 2)}),
      move: (x, y) => change_({x: view.x + 2 * x / canvas.clientWidth, y: view.y - 2 * y / canvas.clientHeight}),
      reset: () => window.change(Object.fromEntries(["azimuth", "elevation", "zoom", "x", "y"].map(name => [name, fields[name].value]))),
      press: at => choose(pick(at)?.part ?? null),
      zoom, point,
    });
    canvas.addEventListener("webglcontextlost", event => {
      event.preventDefault();
      broken = true;
      stand("The graphics processor was lost.");
    });
    canvas.addEventListener("webglcontextrestored", begin);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => change(false));
    begin();
  }

  function controls() {
    const eye = made("select", {"aria-label": "the eye"}, made("option", {value: ""}, "from ..."), ...Object.keys(EYES).map(name => made("option", {}, name)));
    eye.addEventListener("change", () => {
      const [azimuth, elevation] = EYES[eye.value].map(degrees => degrees * Math.PI / 180);
      window.change({azimuth, elevation, x: 0, y: 0});
      eye.value = "";
    });
    const slider = made("input", {type: "range", "aria-label": "where the section lies"});
    const number = made("input", {type: "number", step: "any", "aria-label": "where the section lies, value"});
    const section = choice("section", "Section", AXES);
    section.querySelector("select").addEventListener("change", () => {
      if (view.section) window.change({at: middle[view.section - 1]});
    });
    slider.show = () => {
      slider.hidden = number.hidden = !view.section;
      if (!view.section) return;
      const [from, to] = data.bounds[view.section - 1];
      [slider.min, slider.max, slider.step] = [from, to, 10 ** Math.floor(Math.log10((to - from) / 500))];
      slider.value = view.at;
      number.value = +view.at.toPrecision(6);
    };
    slider.addEventListener("input", () => window.change({at: +slider.value}, true));
    slider.addEventListener("change", () => window.change({at: +slider.value}));
    number.addEventListener("change", () => number.value !== "" && window.change({at: +number.value}));
    slider.show();
    return [choice("colours", "Show", COLOURINGS), eye, section, slider, number];
  }

  function save(done) {
    if (!programs || broken) {
      fetchStill(done);
      return;
    }
    for (const _ of samples("still", 1, Math.max(design.samples, 1)));
    canvas.toBlob(done);
  }

  const fetchStill = done => {
    const copy = made("canvas", {width: byId("still").naturalWidth, height: byId("still").naturalHeight});
    copy.getContext("2d").drawImage(byId("still"), 0, 0);
    copy.toBlob(done);
  };

  // For tests and for the console: what every pixel shows.
  const read = one => {
    const numbers = new Float32Array(4 * one.wide * one.tall);
    gl.bindFramebuffer(gl.FRAMEBUFFER, one.frame);
    gl.readPixels(0, 0, one.wide, one.tall, gl.RGBA, gl.FLOAT, numbers);
    return numbers;
  };
  design.hits = () => ({wide: shown.wide, tall: shown.tall, hits: read(shown.hits), surfaces: read(shown.surfaces), ...shown.seen});
  design.curvatures = () => read(shown.curvatures);
  return {fields, controls, start, change, save};
})();
