"""Functions to arrays: lattices, level lines and meshes.

In come shapes and compiled kernels, out come arrays with what is known of them. In the order of the data:

- `extent`, `form_signs`: a box that holds the boundary, proved; `windows`: where to look; `lattice`: a lattice over it
- `memory`, `progress`: what is refused before it is taken; reports, cancels, time limits; `compiled`: loops
- in the plane: `plane`, `plane_regions`, `isolines`, `contours` and `level_lines`, `plane_leaves`, `active_leaves`,
  `roots`, `outlines`, `boundaries`, `combs`, `sections`; `unseen`, `cut_cells`: what is thinner than a cell; `blanks`,
  `undefined`: where a picture of nothing would show something, where omega has no value
- `fillings`: the inside in triangles, or in space in tetrahedra, up to the boundary
- in space: `meshing` (`rsym.mesh`), `mesher` with `sharp/`, `kernels/` and, for large shapes, `regions/`, or
  `smooth` by marching cubes with `detail`
- `streaming`: meshes larger than memory, in pieces to disk and by a `mesh_writer` into a `mesh_file`; `encoding`:
  triangles as bytes
- `mesh`: triangles; `triangles`, `manifolds`: their measures; `status`: what is known, in brief and in full
- `rules/`: rules of integration inside and on the boundary (`rsym.quadrature`)
- `labels`: which parts points of the boundary belong to; `samples`: points on it or inside; on meshes: `curvatures`,
  `leaf_fields`, `distances`; `offsets`: whether a shell is as thick as was asked for
- letters from data: `boundary_distances` of points, or of the lines of sight of `silhouettes`; `fitting` (`rsym.fit`)
  and its `fit_report`; `sensitivity`: how fast the boundary moves with a letter
- `pencils`, `hits`, `rays`: rays of a picture cast at the equation, and what they meet; `ray_march`: without a
  compiler; `ray_steps`: how a march goes, for all that march
- `stills`: small pictures that results show of themselves
"""
