"""The sign of a formula: its sign form, its leaves and their names.

In comes a shape or a node of a program; out go its leaves, the gates that join them, and formulas of signs.

- `stripping`: a node without what does not change its zeros: negations, factors of one sign, odd powers, what rises
- `gates`: minima and maxima of two, in the order of evaluation
- `sign_form`: a shape as leaves and gates, for the sign a min or a max of two, for the mesher and for sections
- `domains`: where leaves have a value: their domains as leaves beside leaves that always have one
- `steps`: leaves that jump as gates, the condition one of their leaves
- `poles`: leaves with poles as gates, a change of sign through infinity no zero of theirs
- `inside`: kernels that say whether points are inside
- `choices`: choices by a condition, and sums with absolute values, that are minima and maxima
- `lifting`: minima and maxima inside the sums of large leaves as gates
- `radicals`: sums of odd powers as sums of their bases, and leaves without the roots that end at walls
- `branches`: products, quotients and choices anywhere in a leaf as gates
- `leaf_parts`: large leaves as functions of the minima and maxima inside them
- `faces`: the places of a leaf in the formula, by the parts around it; which are active, and what they are called
- `separation`: equal leaves of several parts as several functions
- `leaf_names`: what the leaves are called, by the parts of the shape
- `weights`: functions that vanish on some leaves and nowhere else
- `kleene`: formulas of leaves with three signs, for boxes on which some are known
"""
