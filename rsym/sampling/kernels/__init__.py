"""The mesher's kernels: a sign form to compiled routines over boxes, blocks, edges and points.

In comes a sign form of `logic`; out come `MesherKernels`, functions of NumPy arrays, with letters that `set` changes.
In the order of the data:

- `routines`: LLVM functions with loops and branches, eight lanes at a time
- `form_code`: the leaves with their gradients, the whole form at points, and what is left of it in a block
- `mesher_code`: all routines as LLVM text
- `mesher_kernels`: the text compiled, checked against the interpreter, kept in the process
"""
