"""B-spline surfaces through data or near them: in come points, out goes a net of vertices over two spline spaces.

spline_spaces.py          a degree and knots, open or closed: the basis functions
data_parameters.py        parameters of a net of points: shares of the chord length
spline_knots.py           knots for them, and when data determine a spline
bspline_data.py           parameters and spaces from a net of points and the wishes of the user
scattered_data.py         the same of a cloud of points
band_qr.py, smoothing.py  least squares with short rows; rows that ask second derivatives to vanish
bspline_fitting.py        nets of vertices for data
parameter_correction.py   vertices kept on planes and curves; data moved to where the surface is nearest
curve_fitting.py          the same for curves
spline_surfaces.py        `BSplineSurface`
"""
