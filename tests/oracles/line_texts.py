"""Texts of the kind of fidget and MPR, a name, an operation and its arguments a line: read by numpy, and made here."""

import numpy as np

ONE = {"neg": np.negative, "square": np.square, "sqrt": np.sqrt, "abs": np.abs, "exp": np.exp, "ln": np.log}
ONE |= {"log": np.log, "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos}
ONE |= {"atan": np.arctan, "recip": np.reciprocal, "floor": np.floor}
TWO = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide, "atan2": np.arctan2}
TWO |= {"min": np.minimum, "max": np.maximum, "compare": lambda a, b: np.sign(a - b)}


def lines_of(text):
    """Name, operation and arguments of every line that has them."""
    return [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]


def numbers_of(text, points):
    """The last line at points, negative inside."""
    values, axes = {}, dict(zip(("var-x", "var-y", "var-z"), points, strict=False))
    with np.errstate(all="ignore"):
        for name, operation, *arguments in lines_of(text):
            if operation == "const":
                values[name] = np.float64(arguments[0])
            elif operation in axes:
                values[name] = axes[operation]
            else:
                values[name] = (ONE | TWO)[operation](*(values[argument] for argument in arguments))
    return values[name]


def differences_of(text, points, step=2.0**-20):
    """Central differences of the last line: the gradient but where a kink is nearer than the step."""
    away = [np.eye(len(points))[k][:, None] * step for k in range(len(points))]
    return np.array([(numbers_of(text, points + one) - numbers_of(text, points - one)) / (2 * step) for one in away])


class Writer:
    """A text that grows; the methods return names of lines."""

    def __init__(self):
        self.lines = []

    def line(self, operation, *arguments):
        """Add one."""
        self.lines.append(f"_{len(self.lines):x} {operation} {' '.join(map(str, arguments))}".rstrip())
        return self.lines[-1].partition(" ")[0]

    def const(self, value):
        """A constant, shortened as programs write them."""
        return self.line("const", f"{value:.6g}")

    def folded(self, operation, names):
        """One operation after the other."""
        first, *rest = names
        for name in rest:
            first = self.line(operation, first, name)
        return first

    def length(self, *names):
        """The root of the sum of squares."""
        return self.line("sqrt", self.folded("add", [self.line("square", name) for name in names]))

    def text(self):
        """All lines behind a comment."""
        return "\n".join(["# made for tests", *self.lines, ""])


# Strokes on a cell of 4 by 6: segments (x0, y0, x1, y1), and rings (x, y, radius).
GLYPHS = {
    "A": ([(0, 0, 2, 6), (4, 0, 2, 6), (1, 2, 3, 2)], []),
    "F": ([(0, 0, 0, 6), (0, 6, 3, 6), (0, 3, 2, 3)], []),
    "I": ([(2, 0, 2, 4)], [(2, 5.5, 0.3)]),
    "O": ([], [(2, 2, 1.8)]),
    "P": ([(0, 0, 0, 6)], [(1.5, 4.5, 1.4)]),
    "X": ([(0, 0, 4, 6), (0, 6, 4, 0)], []),
}


def lettering(rows, columns):
    """Letters of segments and rings in the plane: a min of strokes, each a max of half planes or of two circles.

    With 13 rows of 13 letters it has more than 5 000 operations.
    """
    w = Writer()
    x, y = w.line("var-x"), w.line("var-y")
    x, y = w.line("mul", x, w.const(3.5 * columns)), w.line("mul", y, w.const(5.0 * rows))
    whole = []
    for row in range(rows):
        for column in range(columns):
            segments, rings = GLYPHS["AFIOPX"[(row + 5 * column) % 6]]
            left, low = 7 * column - 3.5 * columns + 1, 9 * row - 4.5 * rows + 1
            strokes = [_segment(w, x, y, *np.add(ends, [left, low, left, low])) for ends in segments]
            strokes += [_ring(w, x, y, a + left, b + low, radius) for a, b, radius in rings]
            whole.append(w.folded("min", strokes))
    w.folded("min", whole)
    return w.text()


def _segment(w, x, y, a, b, c, d, half=0.3):
    """Four half planes."""
    size = np.hypot(c - a, d - b)
    p, q = (c - a) / size, (d - b) / size
    along = w.line("add", w.line("mul", x, w.const(p)), w.line("mul", y, w.const(q)))
    across = w.line("sub", w.line("mul", y, w.const(p)), w.line("mul", x, w.const(q)))
    begin, middle = p * a + q * b, p * b - q * a
    sides = [w.line("sub", w.const(begin - half), along), w.line("sub", along, w.const(begin + size + half))]
    sides += [w.line("sub", w.const(middle - half), across), w.line("sub", across, w.const(middle + half))]
    return w.folded("max", sides)


def _ring(w, x, y, a, b, radius, half=0.3):
    """Within a circle and without another."""
    far = w.length(w.line("sub", x, w.const(a)), w.line("sub", y, w.const(b)))
    return w.line("max", w.line("sub", far, w.const(radius + half)), w.line("sub", w.const(radius - half), far))


def lattice(cells):
    """Balls and rods in space, cut by a box; nodes of a row share their squares."""
    w = Writer()
    axes = [w.line("var-x"), w.line("var-y"), w.line("var-z")]
    places = [(2 * k + 1) / cells - 1 for k in range(cells)]
    squares = [[w.line("square", w.line("sub", axis, w.const(place))) for place in places] for axis in axes]
    radius, thin = w.const(0.55 / cells), w.const(0.2 / cells)
    bodies = []
    for i in range(cells):
        for j in range(cells):
            for first, second in ((0, 1), (0, 2), (1, 2)):
                near = w.line("add", squares[first][i], squares[second][j])
                bodies.append(w.line("sub", w.line("sqrt", near), thin))
            bodies += [_ball(w, [squares[0][i], squares[1][j], squares[2][k]], radius) for k in range(cells)]
    one = w.const(1)
    box = [w.line("sub", w.line("abs", axis), one) for axis in axes]
    w.line("max", w.folded("min", bodies), w.folded("max", box))
    return w.text()


def _ball(w, squares, radius):
    return w.line("sub", w.line("sqrt", w.folded("add", squares)), radius)


def blended(count, sharpness=8):
    """Balls along a helix in space, blended: -ln(exp(-s f) + exp(-s g))/s, one after the other, hollowed by a min."""
    w = Writer()
    axes = [w.line("var-x"), w.line("var-y"), w.line("var-z")]
    s, radius = w.const(sharpness), w.const(0.3)
    whole = None
    for turn in np.linspace(0, 2 * np.pi, count):
        centre = (np.cos(turn), np.sin(turn), turn / 3 - 1)
        squares = [w.line("square", w.line("sub", a, w.const(c))) for a, c in zip(axes, centre, strict=True)]
        ball = _ball(w, squares, radius)
        if whole is not None:
            powers = [w.line("exp", w.line("neg", w.line("mul", s, one))) for one in (whole, ball)]
            ball = w.line("neg", w.line("div", w.line("ln", w.folded("add", powers)), s))
        whole = ball
    w.line("max", whole, w.line("sub", w.const(-0.9), axes[2]))
    return w.text()
