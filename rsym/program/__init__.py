"""Formulas to one straight-line program: the table of operations, differentiation, fields.

A `Shape` or an expression comes in; a `Program` goes out: numbered nodes, equal ones once, for values and fields. In
the order of the data:

- `program`: nodes, programs of them, the number formats
- `row`: what is known of an operation; `texts`: how it is written in other languages; rows: `arithmetic`, `elementary`,
  `powers`, `r0`, `r_alpha`, `r0m`, `rp`, `joining`; `operations`: the table, and the sets that follow from it
- `builder`: makes nodes and simplifies what is exact
- `lowering`: from SymPy to nodes, squares completed on the way; `raising`: back
- `differentiation`: derivatives, of one side at corners; `normalisation` to the next order
- `by_letters`: distances of first order, and how they change with a letter
- `calculus`, with the curvatures, `fields`: what is computed of a shape, where it exists
- `expansion`: all operations in those that a backend must know; `tape`: these as rows of numbers
"""
