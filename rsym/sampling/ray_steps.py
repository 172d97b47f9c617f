"""How a march along a ray goes: numbers that the kernels, the march in arrays and the page share, and so agree."""

# Of a pixel: how long a segment may be that a root is looked for in, and what is so short that a point decides. Of a
# wall two points on its sides have the same sign: it is found by segments half as long as it is thick.
CROSSING, SHORTEST = 1 / 64, 2.0**-28
# The same of a page, whose numbers have 24 bits: what is thinner it may miss.
PAGE_CROSSING, PAGE_SHORTEST = 0.25, 0.05
# Of the size of the coordinates: shorter segments, and shorter last steps, are all rounding.
ROUNDED_AWAY = 2.0**-44
# What is known on a shortest segment is compared with one so many times as long: where it is not so many times as
# narrow the form jumps, or is zero to rounding, and a wall is nowhere.
LONGER, NARROWER = 64.0, 8.0
# A ray may graze a surface for long: after so many points in vain the shortest segment is twice as long.
PATIENCE = 8.0
TOO_OFTEN = 5 * PATIENCE  # of points where the form has no value: then what is said is not certain
# Of a pixel: a last step of Newton's method that is longer has not come to a root.
SETTLED = 2.0**-32
HALVINGS = 60  # of what is then left of a bracket
MOST_STEPS = 400
# Of the diagonal of the bounds: closer leaves are taken for one.
ALIKE = 1e-10
# Beams, which go round the rays of a tile of pixels; of the side of a tile: where a beam that may meet something ends.
MOST_BEAM_STEPS, NEAR = 60, 0.5
