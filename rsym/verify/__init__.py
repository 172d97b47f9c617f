"""Checks with an answer: proved where it can be, and called numerical where it is not."""
