"""Shapes as functions of JAX, whose derivatives are rsym's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

from rsym.backends.derivatives import (
    Differentiable,
    checked_corners,
    differentiable,
    finite,
    taken_apart,
    without_gaps,
)
from rsym.model.requirements import optional_package, require_shape
from rsym.model.shape import Shape
from rsym.program.fields import checked_fields, gather
from rsym.program.program import FLOAT32, FLOAT64, precision_named


def to_jax(shape: Shape, fields: Sequence[str] = ("value",), *, at_corners: str = "zero") -> Callable[..., Any]:
    """Fields of a shape as a function of JAX, ``function(x, y[, z], letters)``, to differentiate, map and compile.

    Its derivatives, along coordinates and letters, are programs of rsym (a `jax.custom_jvp`), and so are theirs, to
    any order: they do not cancel, they are as long as the formula asks, and they know corners. What JAX would make of
    the single operations is NaN at corners and next to them, and takes minutes to compile.

    Parameters
    ----------
    shape : Shape
        What to evaluate.
    fields : sequence of str
        As for `compile`.
    at_corners : {"zero", "one-sided", "nan"}
        What stands for a derivative that does not exist, in fields made of derivatives and in the derivatives of all
        fields. ``zero``: 0, so a sum over points is that over the other points. ``one-sided``: first derivatives of
        omega are those of one side, as `compile` has them; where there is none, and for higher ones, 0. ``nan``: NaN,
        as a kernel has it, which spoils every sum. Whatever is chosen, ``singular`` is as a kernel has it, and omega
        itself is NaN where the formula is undefined.

    Returns
    -------
    callable
        Takes coordinates, arrays that broadcast, and a dictionary of letters, numbers or arrays that broadcast too,
        last or as ``letters=``; those left out have their defaults, ranges are not asked. Gives a dictionary of arrays
        as a kernel does: scalars (...), gradient (..., dim), hessian (..., dim, dim). In float64 if an argument is,
        and JAX is told so (``jax.config.update("jax_enable_x64", True)``), else in float32, letters too.

    Raises
    ------
    RsymError
        Without the package jax, for an unknown field or choice at corners, a wrong number of coordinates, or an
        unknown letter.

    Examples
    --------
    >>> import jax, rsym, sympy as sp
    >>> from rsym import x, y
    >>> r = sp.Symbol("r", real=True)
    >>> disc = rsym.Shape(r**2 - x**2 - y**2, (x, y), letters={r: 2})
    >>> function = rsym.to_jax(disc & rsym.Shape(x, (x, y)))
    >>> slope = jax.grad(lambda letters: function(0.5, 1.0, letters)["value"])
    >>> round(float(slope({"r": 2.0})["r"]), 4)
    0.0645
    >>> function(0.5, [1.0, 2.0])["value"].shape
    (2,)
    """
    jax = optional_package("jax", "to_jax")
    require_shape(shape)
    names, corners = checked_fields(fields), checked_corners(at_corners)
    jnp = jax.numpy

    @cache
    def made(precision: str) -> tuple[Differentiable, Callable[..., tuple[Any, ...]]]:
        level = differentiable(shape, names, corners, precision_named(precision))
        return level, _function(jax, level, corners == "nan")

    def function(*coordinates: Any, letters: Any = None) -> dict[str, Any]:
        given = taken_apart(shape, coordinates, letters)
        inputs = [jnp.asarray(value) if isinstance(value, list | tuple) else value for value in given]
        double = jnp.result_type(float, *inputs) == jnp.float64
        level, evaluate = made(FLOAT64.name if double else FLOAT32.name)
        arrays = [jnp.asarray(value, jnp.float64 if double else jnp.float32) for value in inputs]
        whole = gather(dict(zip(level.names, evaluate(*arrays), strict=True)), names, shape.dimension, jnp)
        return whole if corners == "nan" else without_gaps(whole, jnp)

    return function


def _function(jax: Any, level: Differentiable, gaps: bool) -> Callable[..., tuple[Any, ...]]:
    """The functions of a level of all inputs, and how they move with them; `gaps`: whether NaN stays in derivatives."""
    jnp, zero = jax.numpy, jax.custom_derivatives.SymbolicZero
    plain, count = level.function(jnp), len(level.outputs)

    @cache
    def along(names: tuple[str, ...]) -> Callable[..., tuple[Any, ...]]:
        return _function(jax, level.along(names), gaps)

    def values_at(*inputs: Any) -> tuple[Any, ...]:
        whole = jnp.broadcast_shapes(*(value.shape for value in inputs))
        return tuple(jnp.broadcast_to(jnp.asarray(value, inputs[0].dtype), whole) for value in plain(*inputs))

    def moved(inputs: Sequence[Any], ways: Sequence[Any]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        free = [k for k, way in enumerate(ways) if not isinstance(way, zero)]
        values = along(tuple(level.inputs[k] for k in free))(*inputs)
        rates = [jnp.zeros_like(value) for value in values[:count]]
        for k, way, place in level.moving(free):
            slope = values[place] if gaps else finite(values[place], jnp)
            rates[k] = rates[k] + slope * ways[way]
        return values[:count], tuple(rates)

    evaluate = jax.custom_jvp(values_at)
    evaluate.defjvp(moved, symbolic_zeros=True)
    function: Callable[..., tuple[Any, ...]] = evaluate
    return function
