"""The sharp mesher: a sign form and a lattice to closed triangles with exact edges; what the lattice may have missed.

In come compiled kernels with their letters and a lattice (a `Job`); out come triangles with a leaf each (`Finished`).
In the order of the data:

- `signs`: the blocks of cells that the surface may meet, and the signs of their points
- `topology`: the vertices and quads that follow from signs alone
- `crossings`: where edges of the lattice cross the surface, and on which leaf
- `corners`: vertices on edges and corners of the body, by Newton's method; `brackets`: the others, and what it carries
  away, by signs
- `faces`: two triangles for each quad, and their flaws
- `assembly`: these stages one after the other, a vertex for each patch; `pieces`: the same in pieces, on any executor,
  the same bits
- `finishing`: the last stage, on the whole: `untangling` moves vertices along edges, `edits` joins, cuts and stitches,
  `unfolding` turns what still faces inwards; `clusters`: what hangs together
- `stored`: pieces on disk; `mending`: the last stage of those, where there are flaws
- `gates`, `certificates`: cells proved simple; `suspects`, `thickness`: what the others mean
- `features`: the curves where leaves meet
- `loops`: compiled index loops, in threads
"""
