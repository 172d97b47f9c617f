"""Where patches meet: joining them, and how smooth their joints are.

In come patches; out go an `EdgeReport` of every place where they meet, or, of two, a patch that continues the other.

edges.py            a patch along one side of its rectangle of parameters
borders.py          edges with samples: closest points on them, poles to which whole edges shrink
edge_matching.py    stretches that two edges share; gap, angle and jump of curvature along them
continuity.py       the call `continuity_report`, with proofs where they are asked for
edge_report.py      what it answers
meeting.py          whether two edges meet where they are to be joined; what counts as no distance
joined.py           a patch that continues another: itself and a loft of what it misses
joining.py          the call `join`
"""
