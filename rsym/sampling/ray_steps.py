"""How a march along a ray goes: numbers that the kernels, the march in arrays and the page share, and so agree."""

# Of a pixel: how long a segment may be that a root is looked for in, and what is so short that a point decides.
CROSSING, SHORTEST = 0.25, 0.05
# A ray may graze a surface for long: after so many points in vain the shortest segment is twice as long.
PATIENCE = 8.0
TOO_OFTEN = 5 * PATIENCE  # then they lie farther apart than a pixel
MOST_STEPS = 400
# Of the diagonal of the bounds: closer leaves are taken for one.
ALIKE = 1e-10
# Beams, which go round the rays of a tile of pixels; of the side of a tile: where a beam that may meet something ends.
MOST_BEAM_STEPS, NEAR = 60, 0.5
