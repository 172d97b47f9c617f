"""What keeps a shape from being normalised, and other faults of its formula, each with its remedy.

In comes a shape; out goes a `LintReport` of findings, each with its formula, part, definition and line in the model.

linting.py          the call, what it looks at, and the words for slopes, faces and saturation
logic.py            gates that join leaves
zeros.py            leaves and terms compiled together, points on their zero sets
slopes.py           gradients on them, and what to divide by; terms that are nearly constant
sheets.py           faces that two operands share
letter_findings.py  letters whose values or ranges the formula does not bear
places.py           where a formula stands in its model
report.py           what it answers
"""
