"""Truths by other means: formulas of books, sixty digits, shapes whose answer is known by construction."""
