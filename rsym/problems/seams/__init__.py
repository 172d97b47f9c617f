"""Shapes whose formula is zero inside, written anew so that it is zero on the boundary alone.

- `atoms`: the factors of all leaves, each once, and the sign of the form by those of the atoms
- `rows`: the signs of atoms at points that tell, inside, outside and on the boundary
- `clauses`: a conjunction of disjunctions of atoms that rows ask for
- `isolated`: points inside where a form is zero; a ball about each is an atom more
- `proof`: that it has the sign of the form, and is zero on the boundary alone, by boxes
- `slits`: slits without width, that were typed
- `seamless`: a shape written so, and its names
"""
