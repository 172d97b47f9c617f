"""Shapes as functions of PyTorch, whose derivatives are rsym's."""

from __future__ import annotations

import math
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


def to_torch(shape: Shape, fields: Sequence[str] = ("value",), *, at_corners: str = "zero") -> Callable[..., Any]:
    """Fields of a shape as a function of PyTorch, ``function(x, y[, z], letters)``, to differentiate and map.

    Its derivatives, along coordinates and letters, are programs of rsym (a `torch.autograd.Function`), and so are
    theirs, to any order: `backward`, `torch.func` with `grad`, `jvp`, `jacrev` and `vmap` take them. What PyTorch would
    make of the single operations is NaN at corners, and wrong next to them.

    Parameters
    ----------
    shape : Shape
        What to evaluate.
    fields : sequence of str
        As for `compile`.
    at_corners : {"zero", "one-sided", "nan"}
        What stands for a derivative that does not exist, as for `to_jax`.

    Returns
    -------
    callable
        Takes coordinates, tensors that broadcast, and a dictionary of letters, numbers or tensors that broadcast too,
        last or as ``letters=``; those left out have their defaults, ranges are not asked. Gives a dictionary of tensors
        as a kernel does arrays: scalars (...), gradient (..., dim), hessian (..., dim, dim). In float64 if a tensor
        is, else in float32, on the device of the tensors.

    Raises
    ------
    RsymError
        Without the package torch, for an unknown field or choice at corners, a wrong number of coordinates, or an
        unknown letter.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(4 - x**2 - y**2, (x, y))
    >>> function = rsym.to_torch(disc & rsym.Shape(x, (x, y)))  # doctest: +SKIP
    >>> import torch  # doctest: +SKIP
    >>> place = torch.tensor([0.5, 1.0], requires_grad=True)  # doctest: +SKIP
    >>> function(*place)["value"].backward()  # doctest: +SKIP
    """
    torch = optional_package("torch", "to_torch")
    require_shape(shape)
    names, corners = checked_fields(fields), checked_corners(at_corners)

    @cache
    def made(precision: str) -> tuple[Differentiable, Callable[..., tuple[Any, ...]]]:
        level = differentiable(shape, names, corners, precision_named(precision))
        return level, _function(torch, level, corners == "nan")

    def function(*coordinates: Any, letters: Any = None) -> dict[str, Any]:
        inputs = taken_apart(shape, coordinates, letters)
        given = [torch.as_tensor(value) for value in inputs if not isinstance(value, int | float)]
        double = any(value.dtype == torch.float64 for value in given)
        kind, device = torch.float64 if double else torch.float32, given[0].device if given else None
        tensors = [torch.as_tensor(value, dtype=kind, device=device) for value in inputs]
        level, evaluate = made(FLOAT64.name if double else FLOAT32.name)
        whole = gather(dict(zip(level.names, evaluate(*tensors), strict=True)), names, shape.dimension, torch)
        return whole if corners == "nan" else without_gaps(whole, torch)

    return function


class _Names:
    """The functions of NumPy that programs name, of tensors and numbers."""

    def __init__(self, torch: Any, like: Any) -> None:
        self.sqrt, self.abs, self.sin, self.cos = torch.sqrt, torch.abs, torch.sin, torch.cos
        self.exp, self.log, self.power = torch.exp, torch.log, torch.pow
        self.nan, self.inf = math.nan, math.inf
        self._torch, self._like = torch, like

    def _tensor(self, value: Any) -> Any:
        return self._torch.full_like(self._like, value) if isinstance(value, float) else value

    def where(self, test: Any, yes: Any, no: Any) -> Any:
        """One of two values."""
        return self._torch.where(test, self._tensor(yes), self._tensor(no))

    def arctan2(self, u: Any, v: Any) -> Any:
        """The angle of (v, u)."""
        return self._torch.atan2(self._tensor(u), self._tensor(v))


def _function(torch: Any, level: Differentiable, gaps: bool) -> Callable[..., tuple[Any, ...]]:
    """The functions of a level of all inputs, and how they move with them; `gaps`: whether NaN stays in derivatives."""
    count = len(level.outputs)

    @cache
    def along(names: tuple[str, ...]) -> Callable[..., tuple[Any, ...]]:
        return _function(torch, level.along(names), gaps)

    def slopes(inputs: Sequence[Any], free: Sequence[int]) -> dict[tuple[int, int], Any]:
        """The derivatives that are not the constant 0, by output and input."""
        values = along(tuple(level.inputs[k] for k in free))(*inputs)
        return {
            (k, way): values[place] if gaps else finite(values[place], torch) for k, way, place in level.moving(free)
        }

    class Evaluated(torch.autograd.Function):  # type: ignore[misc]
        generate_vmap_rule = True

        @staticmethod
        def forward(*inputs: Any) -> tuple[Any, ...]:
            like = inputs[0].new_zeros(())
            plain = level.function(_Names(torch, like))
            whole = torch.broadcast_shapes(*(value.shape for value in inputs))
            found = [torch.as_tensor(value, dtype=like.dtype, device=like.device) for value in plain(*inputs)]
            return tuple(value.expand(whole).clone() for value in found)

        @staticmethod
        def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
            ctx.save_for_backward(*inputs)
            ctx.save_for_forward(*inputs)

        @staticmethod
        def backward(ctx: Any, *rates: Any) -> tuple[Any, ...]:
            inputs = ctx.saved_tensors
            free = [k for k, needed in enumerate(ctx.needs_input_grad) if needed]
            totals: list[Any] = [None] * len(inputs)
            for (k, way), slope in slopes(inputs, free).items():
                moved = slope * rates[k]
                totals[way] = moved if totals[way] is None else totals[way] + moved
            return tuple(
                None if total is None else _summed(total, value.shape)
                for total, value in zip(totals, inputs, strict=True)
            )

        @staticmethod
        def jvp(ctx: Any, *ways: Any) -> tuple[Any, ...]:
            inputs = ctx.saved_tensors
            whole = torch.broadcast_shapes(*(value.shape for value in inputs))
            rates = [inputs[0].new_zeros(whole) for _ in range(count)]
            free = [k for k, way in enumerate(ways) if way is not None]
            for (k, way), slope in slopes(inputs, free).items():
                rates[k] = rates[k] + slope * ways[way]
            return tuple(rates)

    function: Callable[..., tuple[Any, ...]] = Evaluated.apply
    return function


def _summed(total: Any, shape: Any) -> Any:
    """A sum over the axes along which an array of this shape was broadcast."""
    extra = total.dim() - len(shape)
    axes = [*range(extra), *(extra + k for k, size in enumerate(shape) if size == 1 and total.shape[extra + k] != 1)]
    return total.sum(axes, keepdim=True).reshape(shape) if axes else total
