"""Programs to functions of arrays: numpy, llvm, C, lambdify; kernels that take broadcasting arrays."""
