"""The published models and the figures that reproduce them."""

from rsym.paper.models import MODELS, car, model_path, skeleton_body, streamlined, valve
from rsym.paper.readings import READINGS, Reading
from rsym.paper.reproduction import reproduce

__all__ = [
    "MODELS",
    "READINGS",
    "Reading",
    "car",
    "model_path",
    "reproduce",
    "skeleton_body",
    "streamlined",
    "valve",
]
