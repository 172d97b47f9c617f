"""Regions: at each place only what matters there of a form, as tapes that an executor runs.

In comes a sign form; out come kernels with the methods of those that LLVM compiles, whose time follows what matters in
a box instead of the size of the form. In the order of the data:

- `leaf_tapes`: the leaves as tapes, one for all leaves that are the same but for numbers
- `regions`: what is left of a form in a box, as a list of entries, from the bounds of those of a larger box
- `region_tapes`: the rows of a region; `region_code`: loops that run them, as LLVM text that knows no model
- `region_calls`: these loops by their names
- `kept_regions`: regions that keep the value where questions came, in a tree of boxes
- `large_leaves`: value and gradient of leaves in parts, by regions of their own
- `point_groups`: points that are taken together; `region_kernels`: the kernels of a form, for the mesher
- `own_leaves`: leaves at points of their own, whatever joins them; `region_signs`: their proved signs over boxes
  and far away
"""
