"""The text of GLSL, in the WebGL of a browser."""

import json

import numpy as np
import pytest
from backends.test_languages import FIELDS, case, shipped

import rsym

pytestmark = [pytest.mark.browser, pytest.mark.slow]

# Points are the texels of one texture, values and gradients those of another.
PAGE = """({source, calls, points, letters, width}) => {
    const gl = document.createElement('canvas').getContext('webgl2');
    if (!gl.getExtension('EXT_color_buffer_float')) throw 'no float targets';
    const compiled = (kind, text) => {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, '#version 300 es\\n' + text); gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw gl.getShaderInfoLog(shader);
        return shader;
    };
    const texture = (unit, data) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        const made = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, made);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, 1, 0, gl.RGBA, gl.FLOAT, data);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        return made;
    };
    const program = gl.createProgram();
    gl.attachShader(program, compiled(gl.VERTEX_SHADER,
        'void main(){gl_Position=vec4(vec2[3](vec2(-1,-1),vec2(3,-1),vec2(-1,3))[gl_VertexID],0,1);}'));
    gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, source +
        'uniform highp sampler2D points; out vec4 found;\\n' +
        'void main(){vec4 p=texelFetch(points,ivec2(gl_FragCoord.xy),0);found=vec4(0);' + calls + '}'));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw gl.getProgramInfoLog(program);
    gl.useProgram(program);
    texture(0, new Float32Array(points));
    gl.uniform1i(gl.getUniformLocation(program, 'points'), 0);
    if (letters.length) gl.uniform1fv(gl.getUniformLocation(program, 'letters'), letters);
    const target = texture(1, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.viewport(0, 0, width, 1);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const result = new Float32Array(4 * width);
    gl.readPixels(0, 0, width, 1, gl.RGBA, gl.FLOAT, result);
    return JSON.stringify(Array.from(result, (value) => Number.isFinite(value) ? value : null));
}"""


@pytest.mark.parametrize("letters", ["arguments", "constants"])
@pytest.mark.parametrize("name", ["skeleton", "solids", "car", "vase"])
def test_values_and_gradients_in_single_precision(browser, name, letters):
    shape = shipped(name)
    points, values, expected = case(name)
    points = points[:, 120:].astype(np.float32)
    texels = np.zeros((4, points.shape[1]), np.float32)
    texels[: len(points)] = points
    outs = ", ".join(f"found.{axis}" for axis, _ in zip("xyzw", expected, strict=False))
    asked = {
        "source": rsym.source(shape, "glsl", FIELDS, letters=letters),
        "calls": f"rsym_kernel({', '.join(f'p.{axis}' for axis, _ in zip('xyz', points, strict=False))}, {outs});",
        "points": texels.T.ravel().tolist(),
        "letters": values if letters == "arguments" else [],
        "width": points.shape[1],
    }
    page = browser.new_page()
    page.goto("data:text/html,<p></p>")
    found = np.array(json.loads(page.evaluate(PAGE, asked)), float).reshape(-1, 4).T[: len(expected)]
    page.close()
    kernel = rsym.compile(shape, FIELDS, dtype="float32")(*points)
    expected = np.vstack([kernel["value"], kernel["gradient"].T])
    known = np.isfinite(expected)
    size = np.abs(np.where(known, expected, 0)).max(axis=1, keepdims=True)
    # The language promises 2**-11 of sin and cos.
    near = np.abs(found - expected) <= (5e-3 if name == "vase" else 1e-5) * size
    # At the border of a choice the last place decides.
    assert near[known].mean() > 0.99
