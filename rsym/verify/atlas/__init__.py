"""The plane of two letters: where a boundary is proved smooth, where it is proved not to be, and the line between.

In come a shape and two of its letters; out goes a `SmoothnessAtlas`: rectangles, each with a verdict on every value in
it, and the undecided strips that enclose thresholds.

atlas.py            the call: judge, divide, collect
subjects.py         a plane boundary, a body of revolution or any body, as what is asked for a verdict over ranges
judging.py          the verdict on one rectangle
dividing.py         rectangles in parts, until what is undecided is narrow
grid.py             rectangles as cells of one lattice
strips.py           the strips between certified and refuted cells, their middles and their banks
greatest.py         the greatest curvature at many values, numerically
report.py           what it answers
"""
