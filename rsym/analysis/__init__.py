"""What calculus says of a shape: gradient, Hessian, Laplacian, curvatures, normalisation, maps; contracts.

A shape comes in; expressions, or another shape, go out, R-nodes kept and letters symbolic.

- `differential`: gradient, Hessian, Laplacian, curvatures; `tensors`: derivatives of higher order
- `contracts/`: what a formula promises, from its operations alone
- `normalisation`: omega over the length of its gradient, to any order, and any equation as a shape;
  `transformations`: a shape under any smooth map
- `conditions`: what a function must meet on parts of the boundary, as data; `transfinite`: one function that is
  each of several on its part; `meeting_parts`: smooth where parts meet; `structures`: functions that meet conditions
  whatever is undetermined in them
- `latex`: fields as formulas for a paper
"""
