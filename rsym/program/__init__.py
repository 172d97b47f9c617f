"""Formulas to one straight-line program: the table of operations, differentiation, fields."""
