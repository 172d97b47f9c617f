"""The published models and the figures that reproduce them.

In come the model files of this folder and of `gallery/`; out go shapes, and with `rsym reproduce` every figure of the
source and a page that shows them.

models.py                    the models by name: `rsym.paper.car()` and the others
drawing.py                   what a recipe makes: a figure and what it was made of
claims.py                    what the source claims of surfaces; for which letters it holds
studies.py, preference.py    what it proposes beyond its figures, measured
verdicts.py                  bodies with their verdicts; the gallery
data.py                      letters from data: a fitted body
fields.py                    equations solved on shapes
growth.py                    how time and memory grow, from figures measured once
coons.py, curves.py          parametric surfaces: of edges and corners; through curves and data
figures.py                   all figures as recipes, those of the source in full
readings.py, page.py         how doubtful places are read; the page of a reproduction
reproduction.py              every figure to a file, on two processes
"""

from rsym.facade import attach

# A model is read in a tenth of the time that the figures take to import.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
