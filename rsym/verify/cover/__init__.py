"""All boxes: a region divided until each is settled, or too small to go on.

In comes a model and its bounds; out go the boxes that the boundary lies in, each with what it holds, and those on which
nothing is proved.

1. `inspection` looks at one box by balls: for arcs in the plane with `arcs`, for sheets in space with `surfaces`.
2. The plane: `covering` divides, and discards many boxes at once.
3. Space: `forming` reads off the program which leaves are joined how (`formation`), `repetition` which piece says it
   all, by the `likeness` of its copies; `octree` divides `box_arrays`, `subdivision` keeps them. `images`, `simplest`
   and `centred` bound leaves on many boxes at once, `deciding`, `independence` and `folds` settle most of them.
4. `bending` bounds the curvatures on what was settled (`curvature_forms`).
"""
