"""Verdicts for bodies in space.

In comes a model of three coordinates; out goes a report on the curves and points at which its boundary is less than
analytic. `verdict` is the way through:

1. `forming` reads off the program which leaves are joined how (`formation`), `repetition` which piece says it all, by
   the `likeness` of its copies.
2. `octree` divides `boxes`, a `subdivision` keeps them: `images`, `simplest` and `centred` bound leaves on many boxes
   at once, `deciding`, `independence` and `folds` settle most of them; `inspection` looks at one box by balls, with
   `sheets`, `touching`, `corners` and `breaks`.
3. `tracing` follows the curves in which sheets meet, in the `region` of their boxes: `continuation`, `following`,
   `components`; `jumps` across them.
4. `points` classifies what is left, in `clusters`: located by `candidates`, judged in `judging` by `links` on small
   `spheres`, `contacts`, `rays`, `cusps`, `zeros` and `even_roots`.
5. `bending` bounds curvatures (`curvature_bounds`, `curvature_forms`), `everywhere` and `fibres` speak of letters that
   range; `singular` and `report` say it.
"""
