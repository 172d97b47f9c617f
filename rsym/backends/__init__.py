"""Programs to functions of arrays: numpy, llvm, tapes, C, lambdify; kernels that take broadcasting arrays.

A `Program` comes in, expanded to primitive operations whose texts stand in their rows; a function of arrays, or text,
goes out. In the order of the data:

- `interpreter`: node by node with the plain meanings, the reference, and the check against it
- `numpy_backend`: Python text over arrays
- `vector_code`, `vector_functions`: functions on vectors; `llvm_code`: text, machine code, loops over blocks of points;
  `caches`: compiled code kept on this machine
- `tape_code`, `tape`: an executor of tapes, for programs that are not compiled
- `registry`: the backends by name; `kernel`: `rsym.compile`
- `dialects`: a row for each other language; `languages`: programs as their statements; `vm`: the text of fidget and
  MPR; `source`: `rsym.source`
- `derivatives`: fields and their derivatives, level by level; `jax_functions`, `torch_functions`: what those packages
  are given
- `runtime`, `plain`: what `sympy.lambdify` calls for R-nodes, and that way in whole
"""
