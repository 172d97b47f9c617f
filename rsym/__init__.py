"""rsym: R-functions in Python.

A shape is one real function, positive inside: it is written in SymPy, lowered
once to a straight-line program, differentiated and compiled there, sampled into
level lines and meshes, and drawn.
"""

import logging

from rsym.facade import attach

# A library is silent until a program that uses it asks for its log.
logging.getLogger("rsym").addHandler(logging.NullHandler())

__getattr__, __dir__, __all__ = attach(__name__, __file__)
