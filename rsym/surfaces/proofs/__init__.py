"""Proofs about patches: what holds all along the edges in which they meet."""
