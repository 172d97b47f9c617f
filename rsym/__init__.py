"""rsym: R-functions in Python.

A shape is one real function, positive inside: it is written in SymPy, lowered
once to a straight-line program, differentiated and compiled there, sampled into
level lines and meshes, and drawn.
"""

import logging

import lazy_loader

from rsym.garbage import uncollected

# A library is silent until a program that uses it asks for its log.
logging.getLogger("rsym").addHandler(logging.NullHandler())

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__getattr__ = uncollected()(_load)
