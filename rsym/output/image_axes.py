"""A picture of rays on axes, in the coordinates of the model where its own axes are theirs."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from rsym.model.requirements import require_kind
from rsym.output.axes3d import named_colours
from rsym.output.images import Image
from rsym.output.pictures import figure_of, require_axes

STRAIGHT = 1e-9  # a picture's axis that is this near to a coordinate's is one
WIDTH = 7.0  # inches, of a figure made here


def plot_image(image: Image, *, ax: Axes | None = None) -> AxesImage:
    """Draw a rendered picture, with a colour bar for its values or the names of its parts.

    Where rays are parallel and the picture's axes are those of coordinates, as from the front or from the top, the
    picture has its place in the coordinates of the model, and the axes their names.

    Parameters
    ----------
    image : Image
        What `render` gave.
    ax : Axes, optional
        Where to draw, in the plane; without it a new figure is made, with a colour bar or the names of the parts.

    Returns
    -------
    matplotlib.image.AxesImage
        The picture; its figure is ``artist.get_figure()``.

    Raises
    ------
    RsymError
        For what is no image, or axes that are none.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> image = rsym.render(rsym.sphere(1), camera="top", size=(64, 48))
    >>> artist = rsym.plot_image(image, ax=matplotlib.figure.Figure().add_subplot())
    >>> artist.axes.get_xlabel(), artist.axes.get_ylabel()
    ('$x$', '$y$')
    """
    require_kind(Image, image, "image", "rsym.render(shape)")
    alone = ax is None
    if ax is None:
        from matplotlib import pyplot

        height, width, _ = image.shape
        figure = pyplot.figure(figsize=(WIDTH, WIDTH * height / width), layout="compressed")
        ax = figure.add_subplot()
    require_axes(ax)
    names = _names(image)
    artist = ax.imshow(image.pixels, extent=_extent(image) if names else None, interpolation="antialiased")
    if names:
        ax.set(xlabel=f"${names[0]}$", ylabel=f"${names[1]}$", aspect="equal")
    else:
        ax.set_axis_off()
    if alone:
        figure = ax.figure
        if image.scale is not None:
            figure.colorbar(image.scale, ax=ax, label=image.scale_label, shrink=0.7)
        elif image.legend:
            key = named_colours(figure_of(artist), image.parts)
            key.set_loc("outside right center")
    return artist


def _names(image: Image) -> tuple[str, str] | None:
    """The coordinates to the right and upwards, if they are."""
    view = image.view
    straight = np.abs(view.axes[:2]) > 1 - STRAIGHT
    if view.distance is not None or not straight.any(axis=1).all():
        return None
    right, up = straight.argmax(axis=1)
    return image.coordinates[right], image.coordinates[up]


def _extent(image: Image) -> tuple[float, float, float, float]:
    """The coordinates of the left, right, lower and upper side."""
    view = image.view
    ends = []
    for axis, count in zip(view.axes[:2], view.size, strict=True):
        number = int(np.abs(axis).argmax())
        sign, middle = np.sign(axis[number]), view.middle[number]
        ends += [float(middle + sign * half * view.pixel * count) for half in (-0.5, 0.5)]
    return ends[0], ends[1], ends[2], ends[3]
