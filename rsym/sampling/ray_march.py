"""Rays in arrays, without a compiler: the march of `kernels.march_code` step by step, slower, with the same answers."""

from __future__ import annotations

CROSSING, SHORTEST, PATIENCE, MOST_STEPS = 0.25, 0.05, 8, 400
TOO_OFTEN = 5 * PATIENCE
BISECTIONS, NEWTON_STEPS = 20, 4
ALIKE = 1e-10
