"""Outputs that are stored, so that what changes is seen: `python tests/store.py` stores them anew."""
