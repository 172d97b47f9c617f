"""Whether a function is normalised: its slope on its zero set 1, and further derivatives along the normal 0.

In comes a shape and an order; out goes a `NormalisationReport`.

normalisation.py  the call
derivatives.py    derivatives along the normal, as nodes of a program
cover.py          boxes on which they are bounded
leaves.py         of which leaves omega is made, and where they cross
places.py         points at which they are not what they should be
report.py         what is answered
"""
