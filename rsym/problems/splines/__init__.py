"""Weighted extended B-splines: a grid of cells comes in, functions numbered and extended go out.

- `cardinals`: the pieces of a cardinal B-spline, and which derivatives are asked for
- `joined_cells`: which cells are joined within a shape; `web`: tensor B-splines on a grid, those of few cells inside
  made part of their neighbours, those whose cells fall apart several functions; `rules`: the splines of a rule
- `evaluation`: the values and derivatives of a spline at points

Source: K. Hoellig, U. Reif, J. Wipper (2001), Weighted extended B-spline approximation of Dirichlet problems.
"""
