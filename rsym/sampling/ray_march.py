"""Rays in arrays, without a compiler: the march of `kernels.march_code` step by step, slower, with the same answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.interpreter import interpret_nodes
from rsym.bounds.ray_forms import ray_form
from rsym.bounds.ray_reference import RayReference, along
from rsym.logic.sign_form import Gate, SignForm, through
from rsym.model.shape import Bounds
from rsym.program.expansion import expand
from rsym.program.program import Program
from rsym.sampling.hits import Seen
from rsym.sampling.kernels.form_code import leaf_program
from rsym.sampling.pencils import Pencil

CROSSING, SHORTEST, PATIENCE, MOST_STEPS = 0.25, 0.05, 8, 400
TOO_OFTEN = 5 * PATIENCE
BISECTIONS, NEWTON_STEPS = 20, 4
ALIKE = 1e-10
