"""Functions of one parameter: curves, ribbons, cardinal functions, and what evaluates them."""
