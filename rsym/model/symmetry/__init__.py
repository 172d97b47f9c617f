"""Symmetry: a motif repeated by folding the plane or space onto one cell.

A shape omega0 composed with a map that carries every cell onto the first one
has a copy in each. The maps are isometries on each cell, so every order of
normalisation is kept inside the cells; on the borders between them the result
has a kink, unless the boundary meets the border at a right angle or not at all.

- `waves`, `reflections`: maps that fold a line, space and a turn onto one cell; `evenness`: when they may
- `copies`: motifs that keep within their cells, which need no map
- `cyclic`, `rows`, `mirrors`, `screws`: a motif and such a map make a shape

Source: Maksimenko-Sheiko and Sheiko (2008).
"""
