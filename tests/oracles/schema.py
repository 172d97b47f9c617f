"""The schema of the JSON of all reports, checked: a structure of types, dictionaries and lists of one kind."""

import json
import math

SENTENCE = {"text": str, "proved": bool}
CLASSES = ("unknown", "broken", "G0", "G1", "G2", "G3", "analytic", None)
SCHEMA = {
    "format": str,
    "version": (1,),
    "verdict": ("CERTIFIED", "REFUTED", "DEGENERATE", "UNDECIDED", None),
    "continuity": CLASSES,
    "headline": SENTENCE,
    "sentences": [SENTENCE],
    "statements": [SENTENCE],
    "tables": [{"title": str, "header": [str], "rows": [[str]]}],
    "entries": [SENTENCE | {"defect": bool}],
    "remarks": [SENTENCE],
}


def own_keys(record):
    """The keys of a report beyond the schema."""
    return [name for name in record if name not in SCHEMA]


def complaints(value, schema, where="record"):
    """What is against the schema, in words."""
    if isinstance(schema, dict):
        if not isinstance(value, dict):
            return [f"{where} is no object"]
        missing = [f"{where}.{name} is missing" for name in schema if name not in value]
        known = [name for name in schema if name in value]
        return missing + [one for name in known for one in complaints(value[name], schema[name], f"{where}.{name}")]
    if isinstance(schema, list):
        if not isinstance(value, list):
            return [f"{where} is no list"]
        return [one for k, item in enumerate(value) for one in complaints(item, schema[0], f"{where}[{k}]")]
    if isinstance(schema, tuple):
        return [] if value in schema else [f"{where} is {value!r}"]
    return [] if type(value) is schema else [f"{where} is {value!r}"]


def not_finite(value, where="record"):
    """Numbers that JSON has no word for."""
    if isinstance(value, dict):
        return [one for name, item in value.items() for one in not_finite(item, f"{where}.{name}")]
    if isinstance(value, list):
        return [one for k, item in enumerate(value) for one in not_finite(item, f"{where}[{k}]")]
    return [where] if isinstance(value, float) and not math.isfinite(value) else []


def strictly_read(text):
    """JSON as its standard has it: no NaN, no infinity."""

    def refuse(constant):
        raise AssertionError(constant)

    return json.loads(text, parse_constant=refuse)
