"""Continuity of curves that are given: where their pieces join, and inside them.

In come curves by formulas of one parameter; out goes a `ContinuityReport`.

continuity.py  the call
curves.py      a curve and its derivatives as balls
interiors.py   pieces that are analytic, and where they are not
jumps.py       what jumps from piece to piece
"""
