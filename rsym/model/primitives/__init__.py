"""Primitives: shapes that are given by numbers and points."""
