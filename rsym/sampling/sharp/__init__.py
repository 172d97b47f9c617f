"""The sharp mesher: a sign form and a lattice to closed triangles with exact edges; what the lattice may have missed.

In come compiled kernels with their letters and a lattice (a `Job`); out come triangles with a leaf each (`Finished`).
In the order of the data:

- `octree`: the blocks of cells that the surface may meet
- `signs`, `tables`, `topology`: signs of lattice points; the vertices and quads that follow from them alone
- `crossings`: where edges of the lattice cross the surface, and on which leaf
- `vertices`, `corners`: a vertex for each patch, on its leaf, its edge or its corner
- `faces`: two triangles for each quad, and their flaws
- `assembly`: these stages one after the other; `pieces`, `welding`: the same in pieces, on any executor, the same bits
- `finishing`: the last stage, on the whole; `untangling` moves vertices along edges, `edits` joins, cuts and stitches,
  `unfolding` turns what still faces inwards; `clusters`: what hangs together
- `boxes`, `gates`, `certificates`: cells proved simple; `suspects`, `thickness`: what the others mean
- `features`: the curves where leaves meet
- `leaves`: leaves at points and on boxes; `loops`: compiled index loops, in threads
"""
