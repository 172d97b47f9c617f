"""Verdicts for bodies in space."""
