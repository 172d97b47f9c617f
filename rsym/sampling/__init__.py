"""Functions to arrays: lattices, level lines and meshes."""
