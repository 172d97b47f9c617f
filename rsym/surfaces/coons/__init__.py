"""Patches of edges and corners: Coons, Ferguson, Gregory, and the exact pieces of quadrics and tori."""
