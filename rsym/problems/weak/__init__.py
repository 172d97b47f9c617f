"""Weak forms: Python functions of u, v and a place come in, coefficients of pairs of derivatives go out.

- `traced`: what such a function reckons with: sums of coefficients times a derivative of v, of u, or of both
- `weak_form`: a bilinear and a linear form as data, inside and on parts of the boundary
- `reading`: the functions called once, with what is traced
"""
