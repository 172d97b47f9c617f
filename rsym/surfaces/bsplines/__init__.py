"""B-spline surfaces through data."""
