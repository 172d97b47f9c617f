"""Patches of edges and corners: Coons, Ferguson, Gregory, and the exact pieces of quadrics and tori.

In come curves, points, blends; out goes a Boolean sum of `rsym.surfaces.transfinite`.

ribbons.py                            what a patch does across its edges, as given or as it follows from the edges
corners.py                            what the edges say at the corners, and whether they agree
gregory.py                            twists on which they disagree, both kept
coons_patches.py                      `CoonsPatch`: four edges and what happens across them
bicubic.py                            `BicubicCoons`: a matrix of points, tangents and twists
twists.py, ferguson.py, energies.py   twists of a grid, of one patch; the energies that choose them
optimal.py                            shape parameters that make a patch smoothest
meridians.py, revolution.py, exact.py an arc, what it makes about the axis, quadrics and tori by name
patch_latex.py                        patches as the textbook writes them
"""
