"""Points: what boxes left over, located and classified.

In come boxes that subdivision could not settle, gathered in `clusters`; out goes a place for each of them: proved by
its sheets, its polynomial or all directions from it, else seen in numbers and called so. `candidates` say what vanishes
there, `locating` finds where, and proves it.

1. The plane: `plane`. It takes a proof from `newton_polygon`, `directions` (`slopes`, `slope_rules`) or `tangencies`,
   and numbers from `probing` (`circles`, `branches`, `extrapolation`).
2. Space: `space`. It takes a proof from `judging`: `corners`, their `links` on small spheres, `contacts`, `rays`,
   `cusps`, `zeros`, `even_roots`; numbers are those of `spheres`.
"""
