"""Fairness: bounds on curvature and its variation, extrema of curvature located, measures of bending.

In comes a shape with the verdict of `verify_smoothness`; out goes a `FairnessReport`: proved bounds, extrema that are
proved to be all or called numerical, measures with an estimate of their error.

fairness.py    the call: a curve, a meridian, or a general body
pieces.py      the certified boxes cut along the boundary into pieces of one arc
bending.py     curvatures and their derivatives along an arc, as nodes of a program and in balls over a piece
search.py      pieces divided until their bounds are tight and every zero is settled: extrema and inflections, isolated
measuring.py   lengths, areas, volumes, energies, by quadrature
bodies.py      the report on a general body: bounds from its verdict, extrema from a mesh
report.py      what it answers
designs.py     one shape at several choices of its letters, side by side
"""
