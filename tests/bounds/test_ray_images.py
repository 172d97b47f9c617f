"""Images along rays contain what they are images of: against the plain meanings in extended precision."""

import zlib

import numpy as np
import pytest

import rsym
from rsym.backends.registry import make_function
from rsym.bounds.ray_forms import MODEL, NUMBER, image_function, ray_form
from rsym.bounds.ray_models import ROUNDINGS
from rsym.bounds.ray_reference import RayReference, along
from rsym.logic.sign_form import shape_form
from rsym.paper.models import MODELS as SHIPPED
from rsym.paper.models import model_path
from rsym.program.operations import OPERATIONS
from rsym.program.program import PRECISIONS
from rsym.sampling.active_leaves import active_leaf
from rsym.sampling.leaf_fields import LeafFields

MODELS, PLACES = 1000, 5
OTHERS = {"square": 1, "inverse": 1, "select_cautious": 4, "norm_share": 3, "gap_share": 2}
NAMES = [name for name in OPERATIONS if name not in {"const", "input", "undefined"}]


def meaning(name):
    """What an operation is, on arrays of extended precision."""
    if name == "square":
        return lambda u: u * u
    if name == "inverse":
        return lambda u: 1 / u
    if name == "select_cautious":
        return OPERATIONS["select"].meaning.__get__(np)
    if name == "norm_share":
        return lambda f, g, p: f / OPERATIONS["norm"].meaning(np, f, g, p)
    if name == "gap_share":
        return lambda s, t: OPERATIONS["gap"].meaning(np, s, t) / np.sqrt(s * s + t * t)
    return lambda *operands: OPERATIONS[name].meaning(np, *operands)


def models(generator, dtype):
    """Of every kind: numbers, ranges, lines, quadrics; around 0, with an end at 0, with equal ends, large and small."""
    size = 10.0 ** generator.uniform(-3, 1.5, MODELS)
    middle = generator.normal(0, 1, MODELS) * size * generator.choice([0, 1, 1, 5], MODELS)
    width = size * generator.choice([0, 0, 1e-9, 0.1, 1], MODELS) * generator.random(MODELS)
    low, high = middle - width, middle + width
    touching = generator.random(MODELS) < 0.1
    low[touching], high[touching] = 0, high[touching] - low[touching]
    turned = touching & (generator.random(MODELS) < 0.5)
    low[turned], high[turned] = -high[turned], 0
    linear, quadratic = (
        size * generator.normal(0, 1, MODELS) * generator.choice([0, 0.01, 1], MODELS) for _ in range(2)
    )
    return [part.astype(dtype) for part in (low, high, linear, quadratic)]


def parameters(generator, row):
    """Legal ones, the same for all points."""
    legal = row.parameter
    top = legal.low + 4 if legal.high is None else legal.high
    found = legal.low + (top - legal.low) * (1 - generator.random(MODELS))
    found[::5] = np.clip(np.round(found[::5]), legal.low + (0 if legal.closed else 1), top)
    return found


def in_domain(row, points):
    """Where no operand is negative that must not be."""
    tests = [test for clause in ([] if row is None else row.domain) for test in clause]
    places = [test.place for test in tests if test.kind in {"positive", "nonnegative"} and test.place < len(points)]
    return np.all([points[place] >= 0 for place in places], axis=0) if places else True


def check(name, precision, data=None, seed=0):
    generator = np.random.default_rng([seed, zlib.crc32(name.encode())])
    row = OPERATIONS.get(name)
    arity = OTHERS[name] if name in OTHERS else row.arity
    owner = OPERATIONS["norm"] if name == "norm_share" else row
    kinds = [MODEL] * arity
    if (owner is not None and owner.parameter is not None) or name in {"absolute_power", "signed_power"}:
        kinds[-1] = NUMBER
    if name == "pow" and seed % 2:
        kinds[-1] = NUMBER
    if name in {"add", "mul"} and seed % 2:
        kinds[-1] = NUMBER
    function = image_function(name, tuple(kinds), data=data, precision=precision)
    given, points = [], []
    s = np.concatenate([[-1, 1], generator.uniform(-1, 1, PLACES - 2)]).astype(np.longdouble)[:, None]
    for kind in kinds:
        if kind == NUMBER:
            wild = owner is None or owner.parameter is None
            k = generator.normal(0, 2, MODELS) if wild else parameters(generator, owner)
            k[::3] = np.round(k[::3]) if wild else k[::3]
            given.append(k.astype(precision.dtype))
            points.append(given[-1].astype(np.longdouble))
            continue
        new = models(generator, precision.dtype)
        given += new
        low, high, linear, quadratic = (part.astype(np.longdouble) for part in new)
        share = generator.choice([0, 1, 0.5, generator.random()], (PLACES, MODELS)).astype(np.longdouble)
        points.append(low + share * (high - low) + linear * s + quadratic * s * s)
    outputs = [np.empty(MODELS, precision.dtype) for _ in range(4)]
    make_function(function.program, "numpy", precision).run(given, [], outputs)
    assert all(np.isfinite(output).all() for output in outputs)
    low, high, linear, quadratic = (output.astype(np.longdouble) for output in outputs)
    with np.errstate(all="ignore"):
        extra = () if data is None else (data,)
        value = np.broadcast_to(meaning(name)(*points, *extra), (PLACES, MODELS))
        rest = value - linear * s - quadratic * s * s
        huge = float(ROUNDINGS[precision.name].huge)
        # Extended precision rounds too; beyond the largest numbers, and below the smallest, nothing is promised.
        room = 1e3 / huge + 2.0**-60 * (np.abs(value) + np.abs(linear) + np.abs(quadratic))
        asked = np.isfinite(value) & (np.abs(value) < 1e-9 * huge) & in_domain(row, points)
        wrong = asked & ~((low - room <= rest) & (rest <= high + room))
    where = np.argwhere(wrong)[:3]
    told = [
        (
            float(value[i, k]),
            float(rest[i, k]),
            float(low[k]),
            float(high[k]),
            [float(p[i, k] if p.ndim == 2 else p[k]) for p in points],
        )
        for i, k in where
    ]
    assert not wrong.any(), (int(wrong.sum()), told)
    return low, high, linear, quadratic


DATA = {"powi": (3, 4, 5, 8), "monomial": ((1, 0, -1), (2, 1, -2))}
CASES = [(name, data) for name in [*NAMES, *OTHERS] for data in DATA.get(name, (None,))]


@pytest.mark.random
@pytest.mark.parametrize("precision", PRECISIONS.values(), ids=PRECISIONS)
@pytest.mark.parametrize(("name", "data"), CASES, ids=str)
def test_contains(name, data, precision):
    for seed in range(2):
        check(name, precision, data, seed)


NARROW = ("sin", "exp", "sqrt", "div", "r0_conjunction", "trimming", "gap", "atan2", "joining", "norm", "powi")


@pytest.mark.parametrize("name", NARROW)
def test_models_of_smooth_functions_narrow_with_the_cube(name):
    row = OPERATIONS[name]
    data = 3 if name == "powi" else None
    kinds = [NUMBER if row.parameter is not None and k == row.arity - 1 else MODEL for k in range(row.arity)]
    function = image_function(name, tuple(kinds), data=data)
    steps = np.array([0.1, 0.05, 0.025])
    given = []
    for place, kind in enumerate(kinds):
        value = np.full(3, 2.5 if kind == NUMBER else 1.5 + 0.75 * place)
        given += [value] if kind == NUMBER else [value, value, steps * (1 - 3 * place), steps**2 * place]
    outputs = [np.empty(3) for _ in range(4)]
    make_function(function.program, "numpy", PRECISIONS["float64"]).run(given, [], outputs)
    low, high, _, _ = outputs
    width = high - low
    assert (np.log2(width[:-1] / width[1:]) > 2.7).all(), width


@pytest.mark.random
@pytest.mark.parametrize("name", SHIPPED)
def test_forms_of_shipped_models_contain_them(name):
    shape = rsym.load(model_path(name))
    shape = shape if shape.dimension == 3 else rsym.revolve(shape)
    generator = np.random.default_rng(zlib.crc32(name.encode()))
    reference = RayReference(ray_form(shape_form(shape), lines=len(name) % 2 == 0))
    fields = LeafFields(shape)
    box = np.array(shape.box.ends, float)
    origins = generator.uniform(box[:, 0], box[:, 1], (200, 3))
    directions = generator.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    letters = shape.letters.values_with(None)
    for share in (0.3, 0.01):
        length = np.full(200, share * np.linalg.norm(box[:, 1] - box[:, 0]))
        radius = length * generator.choice([0, 0.1], 200)
        low, high, linear, quadratic = reference(letters, along(origins, directions, 0 * length, length, radius))
        for s in (-1.0, *generator.uniform(-1, 1, 4)):
            shift = generator.normal(size=(200, 3))
            shift *= (radius * generator.random(200) / np.linalg.norm(shift, axis=1))[:, None]
            points = origins + directions * ((s + 1) * length / 2)[:, None] + shift
            found = fields._values(*points.T, letters=letters)
            value = active_leaf(fields.form.gates, [found[leaf] for leaf in fields._values.fields])[0]
            rest = value - linear * s - quadratic * s * s
            known = np.isfinite(value)
            assert ((low <= rest) & (rest <= high))[known].all()
