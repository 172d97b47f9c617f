"""A page to design on: a shape drawn from its equation in the browser, and a slider for each letter.

letters.py                                         ranges of sliders, groups
forms.py                                           the sign form in GLSL: value, model along a ray, derivatives
plane.py                                           fields in the plane in GLSL, omega and its curvature in JavaScript
pages.py                                           the page: texts, data, a still picture
serving.py                                         the page to this computer, and what Python does for it
page.html, page.css, page.js                       what all pages have: letters, history, the address, commands
webgl.js                                           programs, targets, work in steps
space.js, plane.js, mesh.js                        the picture of a body, of a shape in the plane, of a long formula
head.glsl, rays.glsl                               what shaders begin with
trace.glsl, surface.glsl, curvature.glsl           rays, places and normals, second derivatives
shade.glsl, show.glsl, plane.glsl                  light and lines, the screen, a field
"""
