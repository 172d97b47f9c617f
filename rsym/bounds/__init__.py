"""What a program can be on a box: intervals, balls, mean values, far forms, enclosures.

A program not expanded comes in, each R-operation with its exact image; programs of bounds, or balls, go out. In the
order of the data:

- `relations`: operands that have something in common; `cancellations`: terms of a slope that cancel
- `interval_arithmetic`: images in float64, outward; `interval_monotone`: of monotone operations, by their rows;
  `box_images`: of all nodes; `mean_values` sharpen them; `intervals`: bounds as a compiled function
- `ball_arithmetic`, `ball_systems`, `balls`: the same in balls, for proofs, and where operations are defined;
  `ball_series`: Taylor series
- `ray_models`: quadratic models along rays; `ray_functions`, `ray_images`: of each operation; `ray_forms`: a sign form
  as calls of them; `ray_reference`: in arrays
- `far_forms`: signs far away; `enclosures`: ranges of expressions
"""
