"""The model language: text to tokens, tokens to a syntax tree, the tree to SymPy, and never through ``eval``."""
