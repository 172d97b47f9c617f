"""From verdict to design again: the smallest changes of a shape that make its boundary curvature-continuous.

In comes a shape that is refuted; out goes a `RepairReport` of candidates, each certified, each with its price. A move
is a family of changes of one size; to add one, inherit `Move` and name it in `MOVES`.

repairing.py  the call, and the moves that are known by name
anatomy.py    which parts of the formula make a defect
moves.py      what a move is; the move of a letter
rounding.py   roots kept from zero
blending.py   edges replaced by blends
search.py     the smallest size of a family that certifies
prices.py     what a change costs
report.py     what it answers
"""
