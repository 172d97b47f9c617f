"""Surfaces through families and networks of curves."""
