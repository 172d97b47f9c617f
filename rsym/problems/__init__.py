"""Functions on shapes: what interpolates data on the boundary, and what meets conditions there.

A shape with named parts comes in, and conditions by the names of these; expressions and shapes on the same
coordinates go out, letters live.

- `leaf_boxes`: bounds of the leaves and their gradients over boxes, and which of them matter there
- `meetings`: the points where leaves that matter have a zero in common; `sectors`: what is inside around a point
- `corners`: the corners of a plane shape; `reaches`: how far around them nothing else is
- `leaf_jets`: leaves with their derivatives; `corner_functions`: what solutions are like at corners, 0 on both edges
"""
