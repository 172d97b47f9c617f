"""rsym: R-functions in Python.

A shape is one real function, positive inside: it is written in SymPy, lowered
once to a straight-line program, differentiated and compiled there, sampled into
level lines and meshes, and drawn.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
