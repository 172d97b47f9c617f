"""Functions on shapes: what interpolates data on the boundary, and what meets conditions there.

A shape with named parts comes in, and conditions by the names of these; expressions and shapes on the same
coordinates go out, letters live.

- `corners/`: the corners of a plane shape, and what solutions are like there
"""
