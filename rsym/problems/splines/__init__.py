"""Weighted extended B-splines: a grid of cells comes in, functions numbered and extended go out.

- `cardinals`: the pieces of a cardinal B-spline, and which derivatives are asked for
- `web`: tensor B-splines on a grid, those of few cells inside made part of their neighbours
- `evaluation`: the values and derivatives of a spline at points

Source: K. Hoellig, U. Reif, J. Wipper (2001), Weighted extended B-spline approximation of Dirichlet problems.
"""
