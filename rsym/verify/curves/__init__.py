"""Curves in which two sheets of a body meet, followed with proof.

In come two sheets and the boxes in which they meet; out go the curves, how much the sheets differ along them, and the
boxes that may hold more of one.

tracing.py       the call: all curves of two sheets, with their jumps
region.py        the boxes that may hold them
continuation.py  a step along a curve in a tube that holds nothing else
following.py     steps one after the other, to an end, a corner or the beginning; components.py all pieces of a curve
jumps.py         the angle and the curvatures of both sheets along a curve
"""
