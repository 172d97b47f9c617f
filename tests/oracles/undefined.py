"""Expressions without a value of which no form knows the domain: infinity minus infinity."""

import sympy as sp


def without_value(outside):
    """1, and without a value where `outside` is above 710/10**9; for what no domain is a leaf."""
    far = 10**9 * sp.Max(outside, 0)
    return sp.cosh(far) - sp.sinh(far)
