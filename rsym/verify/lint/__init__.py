"""What keeps a shape from being normalised, and other faults of its formula, each with its remedy."""
