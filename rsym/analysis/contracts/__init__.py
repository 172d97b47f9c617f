"""Contracts: what every node of a formula promises, and what that comes to for a shape."""

from rsym.analysis.contracts.leaves import Leaf
from rsym.analysis.contracts.promises import Promise, Singularity
from rsym.analysis.contracts.summary import Contract, contract
from rsym.analysis.contracts.table import promise

__all__ = ["Contract", "Leaf", "Promise", "Singularity", "contract", "promise"]
