"""The sharp mesher: sign bits on a lattice to a closed mesh with exact edges."""
