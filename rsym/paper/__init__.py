"""The published models and the figures that reproduce them."""

from lazy_loader import attach_stub

# A model is read in a tenth of the time that the figures take to import.
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
