// What both pictures ask of WebGL: programs that are linked while a still picture shows, targets in float, one triangle.
const TRIANGLE = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0, 1); }`;
const source = name => byId(`shader-${name}`).textContent.trim();

const NEEDED = "This picture needs a browser with WebGL 2 and float targets.";

function context(canvas) {
  const gl = canvas.getContext("webgl2", {antialias: false, alpha: false, preserveDrawingBuffer: true});
  return gl && gl.getExtension("EXT_color_buffer_float") ? gl : null;
}

// Begins to compile and link; `ready` answers without waiting where the browser can, `finish` gives the program.
function program(gl, text) {
  const parallel = gl.getExtension("KHR_parallel_shader_compile");
  const linked = gl.createProgram();
  const shaders = [[gl.VERTEX_SHADER, TRIANGLE], [gl.FRAGMENT_SHADER, text]].map(([kind, words]) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, words);
    gl.compileShader(shader);
    gl.attachShader(linked, shader);
    return shader;
  });
  gl.linkProgram(linked);
  const uniforms = new Map();
  return {
    ready: () => !parallel || gl.isContextLost() || gl.getProgramParameter(linked, parallel.COMPLETION_STATUS_KHR),
    finish() {
      if (gl.isContextLost()) return;
      if (!gl.getProgramParameter(linked, gl.LINK_STATUS))
        throw new Error(shaders.map(shader => gl.getShaderInfoLog(shader)).join("") + gl.getProgramInfoLog(linked));
      for (let k = gl.getProgramParameter(linked, gl.ACTIVE_UNIFORMS) - 1; k >= 0; k--) {
        const {name, type} = gl.getActiveUniform(linked, k), place = gl.getUniformLocation(linked, name);
        uniforms.set(name.replace("[0]", ""), setter(gl, type, place));
      }
    },
    use(values, textures = {}) {
      gl.useProgram(linked);
      for (const [name, value] of Object.entries(values)) uniforms.get(name)?.(value);
      Object.entries(textures).forEach(([name, texture], k) => {
        gl.activeTexture(gl.TEXTURE0 + k);
        gl.bindTexture(gl.TEXTURE_2D, texture);
        uniforms.get(name)?.(k);
      });
    },
  };
}

function setter(gl, type, place) {
  if (type === gl.FLOAT_MAT3) return value => gl.uniformMatrix3fv(place, false, value);
  const kind = {
    [gl.FLOAT]: "1fv", [gl.FLOAT_VEC2]: "2fv", [gl.FLOAT_VEC3]: "3fv", [gl.FLOAT_VEC4]: "4fv",
    [gl.INT]: "1iv", [gl.INT_VEC2]: "2iv", [gl.SAMPLER_2D]: "1iv",
  }[type];
  return value => gl[`uniform${kind}`](place, typeof value === "number" ? [value] : value);
}

function target(gl, wide, tall, format, filter = gl.NEAREST) {
  const texture = gl.createTexture(), frame = gl.createFramebuffer();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, wide, tall);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  return {
    texture, frame, wide, tall,
    free() {
      gl.deleteTexture(texture);
      gl.deleteFramebuffer(frame);
    },
  };
}

// Fills rows of a target.
function fill(gl, one, from, to) {
  gl.bindFramebuffer(gl.FRAMEBUFFER, one.frame);
  gl.viewport(0, 0, one.wide, one.tall);
  gl.enable(gl.SCISSOR_TEST);
  gl.scissor(0, from, one.wide, to - from);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  gl.disable(gl.SCISSOR_TEST);
}

// All programs linked, then `then`; the still picture stays until that. `failed` is told why there is none.
function whenLinked(programs, then, failed) {
  const look = () => {
    if (!programs.every(one => one.ready())) {
      setTimeout(look, 30);
      return;
    }
    try {
      programs.forEach(one => one.finish());
      then();
    } catch (error) {
      failed(error);
    }
  };
  requestAnimationFrame(() => setTimeout(look, 0));  // the still picture is on the screen first
}

// What is computed of letters alone, in float64, as the shaders take it.
function uploaded(formula) {
  const room = new Float32Array(Math.max(4, 4 * Math.ceil(formula.count / 4)));
  return () => {
    formula.of(values, room);
    return room;
  };
}

// Work in steps between which the browser draws and listens; a later call puts an earlier one off.
function scheduler() {
  let steps = null, asked = false;
  const frame = () => {
    asked = false;
    const begun = performance.now();
    while (steps && performance.now() - begun < 25) if (steps.next().done) steps = null;
    again();
  };
  const again = () => {
    if (steps && !asked) {
      asked = true;
      requestAnimationFrame(frame);
    }
  };
  return work => {
    steps = work;
    again();
  };
}

const sheet = () => {
  const canvas = made("canvas", {tabIndex: 0});
  byId("stage").append(canvas);
  const resized = new ResizeObserver(() => picture.change(false));
  resized.observe(canvas);
  return canvas;
};

const sized = (canvas, share = 1) => [canvas.clientWidth, canvas.clientHeight].map(
  length => Math.max(8, Math.round(length * devicePixelRatio * share)));

const linear = text => {
  const [red, green, blue] = text.match(/[\d.]+/g).map(Number);
  return [red, green, blue].map(one => one <= 10.31475 ? one / 3294.6 : ((one / 255 + 0.055) / 1.055) ** 2.4);
};

// No WebGL 2, no float targets, or all of it lost: the still picture, and a sentence.
function stand(why) {
  for (const canvas of byId("stage").querySelectorAll("canvas")) canvas.hidden = true;
  byId("still").hidden = false;
  byId("still").dataset.why = why;
  say(`${why} The picture shows the model as it was when the page was written; letters and commands work.`);
}
