"""From verdict to design again: the smallest changes of a shape that make its boundary curvature-continuous.

In comes a shape that is refuted; out goes a `RepairReport` of candidates, each certified, each with its price. A move
is a family of changes of one size; to add one, inherit `Move` and name it in `MOVES`.

repairing.py  the call, the moves that are known by name, the smallest size of each that certifies
anatomy.py    which parts of the formula make a defect
moves.py      what a move is; the move of a letter; roots kept from zero
blending.py   edges replaced by blends
prices.py     what a change costs
report.py     what it answers
"""
