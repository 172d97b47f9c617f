"""The suite draws without a screen."""

import os

os.environ["MPLBACKEND"] = "Agg"
