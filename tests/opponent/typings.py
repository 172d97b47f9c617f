"""One body typed in two ways has one answer: `python tests/opponent/hunt.py typings`.

Bodies are cut by lines and circles and put together again, of pieces that are flush or overlap by little; they are
typed in other R-systems, with powers of leaves, lines doubled, turned, moved and scaled. The least eigenvalue, the
integral of Poisson's equation, the rigidity of torsion, the energy of an elastic body and the area have to be those of
the body as it was.
"""

import warnings

import numpy as np
import sympy as sp

import rsym
from rsym import x, y

CELLS = 24
NEAR = 5e-3  # of each other, where both are typed well: corners that point inwards on few cells
SYSTEMS = (rsym.R1, rsym.Rp(2), rsym.Rp(4), rsym.RAlpha(sp.Rational(1, 2)), rsym.R0)


def rational(random, low, high, parts=20):
    return sp.Rational(int(random.integers(round(parts * low), round(parts * high) + 1)), parts)


def plane(formula):
    return rsym.Shape(formula, (x, y))


def body(random):
    """A body with clean leaves."""
    a, b = rational(random, 1, 2), rational(random, 1, 2)
    kind = ("disc", "ellipse", "rectangle", "polygon", "ring", "ell", "discs", "triangle")[random.integers(8)]
    made = {
        "disc": lambda: rsym.disc(a),
        "ellipse": lambda: rsym.ellipse(a, b + 1),
        "rectangle": lambda: rsym.rectangle(2 * a, 2 * b),
        "polygon": lambda: rsym.regular_polygon(int(random.integers(5, 8)), a),
        "ring": lambda: rsym.disc(a + 1) - rsym.disc(b / 2),
        "ell": lambda: rsym.polygon([(-a, -b), (a, -b), (a, 0), (0, 0), (0, b), (-a, b)]),
        "discs": lambda: rsym.disc(a) | rsym.disc(b, (a, 0)),
        "triangle": lambda: rsym.polygon([(-a, -1), (b, -1), (0, a)]),
    }[kind]()
    return kind, made


def cutter(random):
    """A line or a circle as a function."""
    c, s = ((3, 4), (5, 12), (1, 0), (0, 1), (-4, 3), (8, 15))[random.integers(6)]
    size = sp.sqrt(sp.Integer(c) ** 2 + sp.Integer(s) ** 2)
    if random.random() < 0.75:
        return (c * x + s * y) / size - rational(random, -0.6, 0.6)
    return (
        rational(random, 0.3, 0.9) ** 2
        - (x - rational(random, -0.5, 0.5)) ** 2
        - (y - rational(random, -0.5, 0.5)) ** 2
    )


def cut(random, shape):
    """The pieces of a body on both sides of lines and circles, together again."""
    pieces = [shape]
    for _ in range(int(random.integers(1, 3))):
        function = cutter(random)
        over = sp.S.Zero if random.random() < 0.6 else sp.Rational(1, int(random.choice([20, 100, 1000])))
        pieces = [piece & plane(side + over) for piece in pieces for side in (function, -function)]
    random.shuffle(pieces)
    whole = pieces[0]
    for piece in pieces[1:]:
        whole = whole | piece
    return whole


class Case:
    """A body and its other typing, which is so many times as large."""

    def __init__(self, family, plain, typed, scale=1):
        self.family, self.plain, self.typed, self.scale = family, plain, typed, scale

    def __str__(self):
        return f"{self.plain.expression} typed {self.typed.expression}"


def case(seed):
    """The case of a seed."""
    random = np.random.default_rng(seed)
    kind, shape = body(random)
    way = ("cut", "cut", "cut", "system", "times", "doubled", "moved")[random.integers(7)]
    if way == "cut":
        return Case(f"cut {kind}", shape, cut(random, shape))
    if way == "system":
        return Case(f"system {kind}", shape, shape.with_system(SYSTEMS[random.integers(len(SYSTEMS))]))
    if way == "times":
        power = int(random.choice([1, 3]))
        return Case(f"times {kind}", shape, rsym.Shape(1000 * shape.expression**power, (x, y)))
    if way == "doubled":
        function = cutter(random)
        bounds = [(low - 0.1, high + 0.1) for low, high in rsym.extent(shape)]
        return Case(f"doubled {kind}", shape, rsym.Shape(shape.expression * function**2, (x, y), bounds=bounds))
    scale = sp.Integer(10) ** int(random.integers(-3, 4))
    moved = (
        shape.rotate(rational(random, 0, 6)).translate(rational(random, -3, 3), rational(random, -3, 3)).scale(scale)
    )
    return Case(f"moved {kind}", shape, moved, float(scale))


def drum(shape, scale):
    """The least eigenvalue."""
    return rsym.modes(shape, 1, cells=CELLS, estimate=False).values[0] * scale**2


def integral(shape, scale):
    """That of Poisson's equation."""
    return rsym.solve(shape, "-laplacian(u) = 1", 0, cells=CELLS).integral() / scale**4


def rigidity(shape, scale):
    """Of torsion."""
    return float(rsym.torsion(shape, cells=CELLS, estimate=False)) / scale**4


def energy(shape, scale):
    """Of an elastic body that is held all around; the load is one on a volume, so of one size."""
    assert scale == 1
    state = rsym.elasticity(shape, {...: rsym.fixed()}, young=1, poisson=0.3, loads=(1, 0), cells=16, estimate=False)
    return state.energy


def area(shape, scale):
    """By a rule."""
    return float(rsym.measure(shape).area) / scale**2


QUESTIONS = {drum: NEAR, integral: NEAR, rigidity: NEAR, energy: NEAR, area: 1e-9}


def asked(case):
    """The word and what is wrong."""
    wrong, words = [], set()
    moved = case.family.startswith("moved")
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        for question, near in QUESTIONS.items():
            if question is energy and moved:  # the load keeps its direction
                continue
            try:
                one, other = question(case.plain, 1.0), question(case.typed, case.scale)
            except rsym.RsymError as error:
                words.add(f"refused: {error.code}")
                if error.code not in ("cells", "unproved", "unbounded", "bounds"):
                    wrong.append(f"{question.__name__}: {error}")
                continue
            words.add("warned" if told else "answered")
            if not abs(one / other - 1) < near:
                wrong.append(f"{question.__name__} {one} and {other}")
    return ", ".join(sorted(words)), wrong
