"""Primitives: shapes that are given by numbers and points.

Numbers come in, each may be an expression in letters; a `Shape` goes out, normalised as its docstring says, with bounds
where it has an extent. A primitive is a function with its docstring here and its name in a row of `language/pieces.py`.

- `formulas`: fields and boxes that many share
- `plane`, `polygons` (`outlines` of corners, with their formula): in the plane
- `curve_nodes`: curves that know where they run; `curves` are made of them
- `space`, `quadrics`, `helical`, `periodic`: in space
"""
