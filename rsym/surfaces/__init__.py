"""Parametric surfaces: patches over a rectangle of parameters, and their joining."""
