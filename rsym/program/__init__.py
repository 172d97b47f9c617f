"""Formulas to one straight-line program: the table of operations, differentiation, fields.

A `Shape` or an expression comes in; a `Program` goes out: numbered nodes, equal ones once, for values and fields. In
the order of the data:

- `program`, with the number formats of `precision`: nodes, and programs of them
- `row`: what is known of an operation; `sides` and `scaling`: what jumps part, and how things grow far away, in rows;
  `powers`: roots and powers in primitive operations
- rows: `arithmetic`, `elementary`, `smooth_steps`, `r0`, `r_alpha`, `r0m`, `rp`, `joining`, `signed_powers`;
  `operations`: the table, and the sets that follow from it
- `builder`: makes nodes and simplifies what is exact, by `constant_ranges` too
- `lowering`: from SymPy to nodes; `quadratics`: squares completed on the way
- `differentiation`, `one_sided`: derivatives; `jumps`: where two sides of a choice differ; `definedness`
- `calculus`, with `curvatures` and `normalisation`, `fields`: what is computed of a shape
- `expansion`: all operations in those that a backend must know
"""
