"""The kernels of mesher and caster: a sign form to compiled routines over boxes, blocks, edges, points and rays.

In comes a sign form of `logic`; out come `MesherKernels` and `RayKernels`, functions of NumPy arrays; letters change
and nothing is compiled. In the order of the data:

- `routines`: LLVM functions with loops and branches, eight lanes at a time
- `form_code`: the leaves with their gradients, the whole form at points, and what is left of it in a block
- `mesher_code`: all its routines as LLVM text, compiled and kept on the machine
- `mesher_kernels`: the code, checked against the interpreter, kept in the process
- `ray_code`: models of a form along rays, what matters of it in a beam, its active leaf at points; `ray_state`: the
  state of eight rays; `march_code`: their march and the roots; `picture_code`: tiles and rays as LLVM text;
  `ray_kernels`: compiled, for `rays`
- of large forms, `leaf_kinds`: leaves that are the same but for numbers; `table_layout`: where tables of leaves and
  gates lie; `table_code`: loops over these instead of branches; `region_code`: such a table of what is left of a form;
  `cells_code`: what matters where rays are, in the cells of the bounds
"""
