"""Normalising before and after revolving: the gradient commutes with revolution, the Laplacian gains omega_rho/rho."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from rsym.analysis.differential import gradient
from rsym.analysis.normalisation import normalise
from rsym.model.constructions import revolve
from rsym.model.shape import Shape
from rsym.output.fields import plot_field
from rsym.paper.models import skeleton_body

LEVELS = (-4.0, 2.0)  # what the Laplacians of a profile one unit thick span outside singular spots
BOX = ((-7.0, 7.5), (-3.0, 3.0))
RESOLUTION = 400


def gain(shape: Shape) -> Shape:
    """What revolving about x adds to the Laplacian of a plane field f: f_y/y, as a field in the plane.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> gain(rsym.Shape(1 - x**2 - y**2, (x, y))).expression
    -2
    """
    across = shape.coordinates[1]
    return shape.replace(expression=gradient(shape)[1] / across)


def draw() -> Figure:
    """Three panels on the meridian plane: the Laplacian of the plane field, of the revolved one, and their difference.

    The field is omega_n of Fig. 11. Normalising the revolved body gives the same function as revolving the
    normalised profile, so one revolved panel stands for both orders.
    """
    profile = skeleton_body()
    body = revolve(profile)
    plane = normalise(profile)
    levels = MaxNLocator(14).tick_values(*LEVELS)
    figure = Figure(figsize=(9.0, 6.6), layout="compressed")
    axes = figure.subplots(3, 1, sharex=True)
    artists = [
        plot_field(profile, "normalised_laplacian", ax=axes[0], levels=levels, bounds=BOX, resolution=RESOLUTION),
        plot_field(
            body,
            "normalised_laplacian",
            ax=axes[1],
            levels=levels,
            bounds=(*BOX, BOX[1]),
            resolution=RESOLUTION,
            section={"z": 0.0},
        ),
        plot_field(gain(plane), ax=axes[2], levels=levels, bounds=BOX, resolution=RESOLUTION),
    ]
    titles = (
        r"$\Delta\omega_n$ in the plane",
        r"$\Delta\omega_n$ of the body of revolution, on its meridian plane $z = 0$",
        r"their difference, $\frac{1}{\rho}\,\frac{\partial\omega_n}{\partial\rho}$",
    )
    for ax, artist, title in zip(axes, artists, titles, strict=True):
        _finish(figure, ax, artist, title)
    return figure


def _finish(figure: Figure, ax: Axes, artist: QuadContourSet, title: str) -> None:
    ax.set_title(title, fontsize=11)
    ax.label_outer()
    figure.colorbar(artist, ax=ax, pad=0.02, fraction=0.04).ax.tick_params(labelsize=7)
