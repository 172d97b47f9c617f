"""What HOWTO.md says of adding, done: by registration, used end to end, and taken back."""

import math
from pathlib import Path

import mpmath
import numpy as np
import pytest
import sympy as sp

import rsym
from rsym.analysis.contracts import elementary, table
from rsym.language import functions, syntax
from rsym.model.functions import FUNCTIONS, Function
from rsym.model.nodes import RealNode
from rsym.model.rnodes import R0Operation
from rsym.model.systems import RSystem
from rsym.program.lowering import LOWERINGS
from rsym.program.operations import OPERATIONS, register
from rsym.program.program import Node
from rsym.program.row import UP, Operation, lipschitz, nonzero

HOWTO = Path(rsym.__file__).parent / "HOWTO.md"


@pytest.fixture
def taken_back():
    """Tables as they were."""
    tables = (OPERATIONS, FUNCTIONS, LOWERINGS, table.PROMISES, functions.SYSTEMS, syntax.ARITIES)
    before = [dict(one) for one in tables]
    yield
    for one, kept in zip(tables, before, strict=True):
        for name in set(one) - set(kept):
            del one[name]


class Arsinh(RealNode):
    """arsinh(u)."""

    runtime_name = "arsinh"

    def as_roots(self):
        return sp.asinh(self.args[0])

    def fdiff(self, argindex=1):
        return 1 / sp.sqrt(1 + self.args[0] ** 2)

    def numeric(self, arguments):
        return sp.asinh(arguments[0])


def arsinh_expansion(b, node):
    """log(|u| + sqrt(1 + u**2)) with the sign of u."""
    (u,) = node.arguments
    size = b.abs(u)
    value = b.make("log", b.add(size, b.sqrt(b.add(b.const(1), b.square(u)))))
    return b.select(b.const(0), u, b.neg(value), value)


ARSINH = Operation(
    1,
    lambda np, u: np.arcsinh(u),
    arsinh_expansion,
    lambda b, number, node, d: b.div(d[0], b.sqrt(b.add(b.const(1), b.square(node.arguments[0])))),
    lipschitz(1),
    formula=Arsinh,
    grows=(UP,),
    at=lambda u: u.asinh(),
    rounding="elementary",
    analytic=(),
    strict=True,
    parity="odd",
    zeros=("0",),
)


def test_an_operation_is_a_row_and_its_class(taken_back):
    register({"arsinh": ARSINH})
    row = Function(Arsinh, math.asinh, "arsinh", analytic=True, entire=True, grows=1, sign="odd")
    FUNCTIONS["arsinh"] = row
    syntax.ARITIES["arsinh"] = row.arity
    table.PROMISES[Arsinh] = elementary.growing(row)
    text = "coordinates x y z\nbounds x [-2, 2] y [-2, 2] z [-2, 2]\nshape = 1 - arsinh(x)^2 - y^2 - z^2"
    body = rsym.loads(text)
    for backend in ("llvm", "numpy"):
        found = rsym.compile(body, ("value", "gradient"), backend=backend)(0.5, 0.25, 0.0)
        assert float(found["value"]) == pytest.approx(1 - math.asinh(0.5) ** 2 - 0.0625, rel=1e-14)
        assert found["gradient"][0] == pytest.approx(-2 * math.asinh(0.5) / math.hypot(1, 0.5), rel=1e-13)
    mesh = rsym.mesh(body, 24)
    assert np.abs(1 - np.arcsinh(mesh.vertices[:, 0]) ** 2 - (mesh.vertices[:, 1:] ** 2).sum(axis=1)).max() < 1e-2
    assert rsym.verify_smoothness(body).verdict == "CERTIFIED"
    assert rsym.lint(body) is not None
    assert "log" in rsym.source(body, "c")


class Quartic(R0Operation):
    """f + g -+ (f**4 + g**4)**(1/4)."""

    kept = 3

    def pair_as_roots(self, f, g):
        return f + g + self.sign * (f**4 + g**4) ** sp.Rational(1, 4)

    def partial(self, f, g):
        return 1 + self.sign * f**3 / (f**4 + g**4) ** sp.Rational(3, 4)

    def pair_numeric(self, f, g, *parameters):
        return f + g + self.sign * (f**4 + g**4) ** sp.Rational(1, 4)

    def system_text(self, printer):
        return "Quartic"


class QuarticConjunction(Quartic):
    sign, runtime_name = -1, "quartic_conjunction"


class QuarticDisjunction(Quartic):
    sign, runtime_name = 1, "quartic_disjunction"


class QuarticSystem(RSystem):
    def conjunction(self, *operands):
        return QuarticConjunction(*operands)

    def disjunction(self, *operands):
        return QuarticDisjunction(*operands)


def quartic(sign):
    """The rows of R_p at p = 4, with parameters put in."""
    word = "conjunction" if sign < 0 else "disjunction"
    rp = OPERATIONS[f"rp_{word}"]

    def with_four(b, node):
        return Node(f"rp_{word}", (*node.arguments, b.const(4)))

    return Operation(
        2,
        lambda np, f, g: rp.meaning(np, f, g, 4.0),
        lambda b, node: rp.expansion(b, with_four(b, node)),
        lambda b, number, node, d: rp.derivative(b, number, with_four(b, node), d),
        lipschitz(2),
        formula=QuarticConjunction if sign < 0 else QuarticDisjunction,
        grows=(UP, UP),
        at=lambda f, g: rp.at(f, g, f * 0 + 4),
        rounding="sum",
        analytic=(nonzero(0, 1),),
        strict=True,
        symmetric=True,
        homogeneous=True,
        logic="and" if sign < 0 else "or",
        zeros=rp.zeros,
    )


@pytest.mark.slow
def test_an_r_system_is_two_rows_and_its_classes(taken_back):
    register({"quartic_conjunction": quartic(-1), "quartic_disjunction": quartic(1)})
    functions.SYSTEMS["Quartic"] = QuarticSystem()
    text = (
        "system Quartic\ncoordinates x y z\nbounds x [-2, 2] y [-2, 2] z [-2, 2]\n"
        "shape = rfAND(1 - x^2 - y^2 - z^2, rfOR(z, x - 1/4))"
    )
    body = rsym.loads(text)
    assert body.expression.has(QuarticConjunction)
    g, h = mpmath.mpf(0), mpmath.mpf(0.25)
    either = g + h + (g**4 + h**4) ** 0.25
    for backend in ("llvm", "numpy"):
        found = rsym.compile(body, ("value", "gradient"), backend=backend)(0.5, 0.0, 0.0)["value"]
        expected = 0.75 + either - (mpmath.mpf(0.75) ** 4 + either**4) ** 0.25
        assert float(found) == pytest.approx(float(expected), rel=1e-13)
    assert float(rsym.lambdify(body)(0.5, 0.0, 0.0)["value"]) == pytest.approx(float(expected), rel=1e-13)
    mesh = rsym.mesh(body, 24)
    ball = 1 - (mesh.vertices**2).sum(axis=1)
    assert np.abs(np.minimum(ball, np.maximum(mesh.vertices[:, 2], mesh.vertices[:, 0] - 0.25))).max() < 1e-2
    assert rsym.verify_smoothness(body).continuity == "G0"
    assert str(body.contract())


def test_the_text_says_how():
    text = HOWTO.read_text()
    for section in ("An operation", "An R-system"):
        part = text.partition(f"## {section}\n")[2].partition("\n## ")[0]
        assert 3 <= len(part.strip().splitlines()) <= 10, section
