"""Blending functions with shape parameters."""
