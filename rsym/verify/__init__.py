"""Checks with an answer: proved where it can be, and called numerical where it is not.

In comes a shape with bounds and letters; out goes a report: a verdict, places and sentences, each proved or not. The
plane is here, space in bodies/; fairness/, repair/, atlas/ and lint/ ask both for more.

1. What is asked: `smoothness` and `threshold`, for which `revolution`, `cleaning` and `cells` write the formula so that
   boxes can decide it; `normalisation` (`normal_cover`, `normal_places`, `normal_derivatives`, `normalisation_report`);
   `continuity` of given curves (`curves`, `curve_interiors`, `jumps`, `constants`).
2. One box: `local` encloses nodes; `domains`, `locus`, `generators`, `classes`, `folding` and `borders` say what the
   boundary is made of there, `polynomials`, `cyclotomic`, `contact_relations`, `root_classes` and `resolution` by
   algebra; `krawczyk` finds zeros; `examination` joins them.
3. All boxes: `pruning`, `covering`; `evidence` whether there is a boundary at all, `holes` where denominators vanish.
4. Places: `joints`, `edges`, `breaks` and `lifting` where two arcs meet; `suspects` what boxes leave over, by
   `locating`, `vanishing`, `tangencies`, `directions` (`slopes`, `slope_rules`) and `newton_polygon`, which prove, and
   `probing` (`circles`, `branches`, `extrapolation`), which is numerical.
5. What follows: `conclusions` the verdict and its sentences, `account` that nothing was lost, `report` to read.
"""
