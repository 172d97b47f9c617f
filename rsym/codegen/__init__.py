"""Formulas to functions: the program, its differentiation and its backends."""
