"""Functions on shapes: what interpolates data on the boundary, and what meets conditions there.

A shape with named parts comes in, and conditions by the names of these; expressions and shapes on the same
coordinates go out, letters live.

- `conditions`: conditions by name, brought to the leaves of the shape
- `meetings`: where parts of the boundary are, and where they meet; `parts`: that they are there and data agree
- `interpolation`: values and normal derivatives on parts, by one function
- `solution_structures`: functions with undetermined ones in them that meet conditions
"""
