"""Lines over a domain: what the operators of `rsym.surfaces.projections` stand on."""
