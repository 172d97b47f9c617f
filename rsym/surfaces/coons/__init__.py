"""Patches of edges and corners: Coons, Ferguson, Gregory, and the exact pieces of quadrics and tori.

In come curves, points, blends; out goes a Boolean sum of `rsym.surfaces.transfinite`.

coons_patches.py          `CoonsPatch`: four edges and what happens across them, as given or as it follows from them
corners.py                what the edges say at the corners, whether they agree, and both kept where they do not
bicubic.py                `BicubicCoons`: a matrix of points, tangents and twists
twists.py, energies.py    twists of a grid, of one patch; the energies that choose them
optimal.py                shape parameters that make a patch smoothest
revolution.py, exact.py   an arc and what it makes about the axis; quadrics and tori by name
patch_latex.py            patches as the textbook writes them
"""
