"""What calculus says of a shape, in closed form: gradient, Hessian, Laplacian, normalisation, curvature."""
