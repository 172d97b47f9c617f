"""Contracts: what every node of a formula promises, and what that comes to for a shape."""

from rsym.model.contracts.leaves import Leaf
from rsym.model.contracts.promises import Promise, Singularity
from rsym.model.contracts.summary import Contract, contract
from rsym.model.contracts.table import promise

__all__ = ["Contract", "Leaf", "Promise", "Singularity", "contract", "promise"]
