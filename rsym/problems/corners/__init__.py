"""Corners of shapes in the plane, and functions that are like solutions there, 0 on both edges however curved.

A shape comes in, and which leaves have natural conditions; corners with angle, leaves and reach go out, and functions
of points with their derivatives. In the order of the data:

- `leaf_boxes`: bounds of the leaves and their gradients over boxes, and which of them matter there
- `common_zeros`: the points where leaves that matter meet; `sectors`: what is inside around such a point
- `reaches`: how far around corners nothing else is; `corners`: all of that
- `leaf_jets`: leaves with their derivatives; `growth`: what convection and a diffusion that varies make of functions
- `leaf_coordinates`: in which both edges are straight; `corner_functions`: powers and logarithms in these, by
  `singular_loops`; `formulas`: these as expressions
- `goursat`: exponents of elastic bodies and plates; `wave_functions`: what belongs to them
- `choice`: which corners have some beside splines
"""
