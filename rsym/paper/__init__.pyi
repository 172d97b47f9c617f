from .models import MODELS, car, model_path, skeleton_body, streamlined, valve
from .readings import READINGS, Reading
from .reproduction import reproduce

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
