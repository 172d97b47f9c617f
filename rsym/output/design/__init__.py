"""A page to design on: a shape from its equation, a slider for each letter.

letters.py                                         ranges of sliders, groups
forms.py, plane.py                                 the shape in GLSL and JavaScript
pages.py                                           the page: texts, data, a still picture
page.html, page.css, page.js                       what all pages have
"""
