"""Rules of integration on shapes, of which every leaf and corner is known.

In comes a shape, out come points and weights inside and on the boundary. In the order of the data:

- `leaf_functions`: the leaves of the sign form at points and over boxes
- `division`: cells divided until each is inside, outside, or has a height along which its leaves only rise or fall
- `isolation`: all roots of functions of one variable; `curves`: the functions of one variable in a cut cell
- `columns`, `bases`: Gauss, roots, Gauss on cut cells in the plane; `segments`: of their bases; `lines`,
  `walks`: along their heights
- `space`: the same over the parts of a plane base; `sampled`: where nothing is proved
- `deadlines`: the time; `portions`: all of it in some cells; `quadrature`: `rsym.quadrature`; `refinement`: until
  two rules agree; `integrals`: `rsym.integrate`; `measures`: `rsym.measure`
- `gaps`: where a shape has gaps thinner than the cells of a rule; `sides`: which of its cells, next to each other, it
  is not joined in
"""
