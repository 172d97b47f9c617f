"""Blending functions with shape parameters: what a patch weighs its edges and ribbons with.

In come a family and its parameters, or a smooth step; out goes a `HermiteBlend`, its functions as one curve.

blend_families.py    formulas: polynomials, and two families that keep arcs of circles; as a person writes them
blending.py          the blend of a class, by name, from a smooth step, cut down to a lower class
blending_checks.py   what is asked of it: conditions at the ends, bounds, and how the answer is known
"""
