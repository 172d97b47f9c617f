"""Solution structures of a shape, from conditions on its named parts."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from rsym.analysis.conditions import BoundaryCondition, Clamped, Robin, Switched, UnknownLevel
from rsym.analysis.structures import Conditioned, SolutionStructure, structure_of
from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.problems.conditions import Name, given_by_name
from rsym.problems.parts import formula, parts_of
from rsym.problems.seams.seamless import seamless


def solution_structure(shape: Shape, conditions: Any, *, length: Any = None) -> SolutionStructure:
    """A function with undetermined functions in it that meets boundary conditions whatever these are.

    For one part with its weight w, normalised to order 1 and positive inside, n the outward normal:

        u = g                       u = g + w*Phi_1
        u = g, du/dn = h            u = g - w*(grad w . grad g + h) + w**2*Phi_1
        du/dn + c*u = h             u = Phi_1 - w*(grad w . grad Phi_1 - c*Phi_1 + h) + w**2*Phi_2

    Parts with different conditions are put together as `structure_of` says: values are interpolated, and the term of
    slopes is multiplied by the joining of all weights. The conditions hold identically, in closed form.

    Parameters
    ----------
    shape : Shape
        In the plane or in space; its parts have names, by ``shape.named(name)``.
    conditions : mapping, or one condition for all of the boundary
        Names of parts to `dirichlet` (or a bare value), `neumann`, `robin`, `clamped`, `constant` or `supported`,
        ``...`` for the rest. Of a supported part the value is met; its moment is a natural condition of energies. A
        part at an unknown level gets a letter, ``C_1``. A part of which nothing is said is met by no condition.
    length : number or expression, optional
        That of `normalise`, as for `interpolate`.

    Returns
    -------
    SolutionStructure
        ``.expression`` with functions ``Phi_1(x, y)`` of SymPy; ``.with_functions(...)`` a shape with expressions for
        them; ``.with_values()`` a shape with letters for them and their slopes. Where parts meet slopes do not exist.

    Raises
    ------
    RsymError
        As `interpolate`, of which it has the values; for letters named like what is undetermined.

    Source: Rvachev (1982); Sukumar and Srivastava (2022), section 5.

    Examples
    --------
    Polynomials with letters for coefficients, to be fitted:

    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    >>> structure = rsym.solution_structure(ring, {"rim": rsym.robin(3, x), "bore": 1})
    >>> a, b = sp.symbols("a b", real=True)
    >>> u = structure.with_functions(a * x + b * y, 0, letters={a: 1, b: 2})
    >>> found = rsym.compile(u, ("value", "gradient"))(1.2, 1.6, letters={"a": 7.5})
    >>> float(found["gradient"] @ [0.6, 0.8] + 3 * found["value"]).__round__(12)
    1.2

    A network: points of collocation by `sample`, the structure as a function of JAX (of PyTorch by `to_torch`), which
    takes the values of the network and their slopes for letters. It meets the conditions before it has learnt:

    >>> import jax, jax.numpy as jnp
    >>> jax.config.update("jax_enable_x64", True)
    >>> values = rsym.to_jax(structure.with_values())
    >>> def network(weights, x, y):
    ...     return weights[1] @ jnp.tanh(weights[0] @ jnp.array([x, y, 1.0]))
    >>> def solution(weights, x, y):
    ...     phi, (phi_x, phi_y) = jax.value_and_grad(network, (1, 2))(weights, x, y)
    ...     return values(x, y, {"Phi_1": phi, "Phi_1_x": phi_x, "Phi_1_y": phi_y, "Phi_2": phi})["value"]
    >>> weights = jnp.sin(jnp.arange(15.0)).reshape(5, 3), jnp.cos(jnp.arange(5.0))
    >>> slopes = jax.vmap(jax.value_and_grad(solution, (1, 2)), (None, 0, 0))
    >>> rim = rsym.sample(ring, 1000, over="rim", rng=1)
    >>> level, (u_x, u_y) = jax.jit(slopes)(weights, *jnp.asarray(rim.points.T))
    >>> residual = u_x * rim.normals[:, 0] + u_y * rim.normals[:, 1] + 3 * level - rim.points[:, 0]
    >>> bool(abs(residual).max() < 1e-13)
    True
    """
    require_shape(shape)
    given: dict[Name, BoundaryCondition] = {}
    letters = shape.letters
    for name, condition in given_by_name(shape, conditions).items():
        if isinstance(condition, Switched):
            raise RsymError(
                f"what is said of {name!r} changes on it: there is no formula for that",
                code="condition",
                remedy="solve takes it",
            )
        values = {}
        for one in fields(condition):
            expression, more = formula(getattr(condition, one.name), shape, f"the condition on {name!r}")
            values[one.name], letters = expression, letters.merge(more)
        given[name] = replace(condition, **values)
    known = seamless(shape.replace(letters=letters), False).shape
    parts = parts_of(known, given)
    parts.require_all()
    parts.require_agreement(
        {name: given[name].values[0] for name in parts.leaves if not isinstance(given[name], Robin | UnknownLevel)}
    )
    weights = parts.weights(1, length)
    pieces = {
        name: Conditioned(given[name], weights.of(leaves), weights.factor(leaves))
        for name, leaves in parts.leaves.items()
    }
    parts.require_slopes(
        {name: one.weight for name, one in pieces.items() if isinstance(one.condition, Robin | Clamped)}
    )
    return structure_of(list(pieces.values()), shape.coordinates, letters, parts.box)
