"""B-spline surfaces through data or near them: in come points, out goes a net of vertices over two spline spaces.

spline_spaces.py          a degree and knots, open or closed: the basis functions
data_parameters.py        parameters of a net of points, shares of the chord length; knots for them
band_qr.py                least squares with short rows
bspline_fitting.py        nets of vertices for data, smoothness among them
bspline_data.py           parameters and spaces from points and the wishes of the user; curves
scattered_data.py         the same of a cloud of points
parameter_correction.py   vertices kept on planes and curves; data moved to where the surface is nearest
spline_surfaces.py        `BSplineSurface`
"""
