"""Corners of shapes in the plane, and the functions that solutions have there.

A shape comes in, with which leaves have values; functions of their own beside the splines go out.

- `places`: where two leaves of the boundary meet, at which angle, and how far other leaves are
- `singular`: powers and logarithms in the coordinates of the two leaves
"""
