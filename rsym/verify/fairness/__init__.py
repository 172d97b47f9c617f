"""Fairness: bounds on curvature and its variation, extrema of curvature located, measures of bending."""
