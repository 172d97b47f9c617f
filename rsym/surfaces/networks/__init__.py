"""Surfaces through families and networks of curves: in come curves, out go lofts, Gordon's surface, composite patches.

families.py          families of curves, checked
intersections.py     where two curves meet; the grid of parameters of two families
reparametrisation.py another pace, start or part of a curve
curve_networks.py    a network: each curve of one family meets all of the other
gordon.py            surfaces through a family, through a network, through a grid of points
composite.py         a Coons patch in every cell
transition.py        from a line on one patch to one on another
"""
