"""Stores the outputs anew that `package/test_stored_hashes.py` compares: `python tests/store.py [GROUP ...]`.

Items that have changed are printed by name; those that have not keep what is stored, to the digit.
"""

import json
import sys
import warnings
from pathlib import Path

from stored.items import GROUPS
from stored.record import compared

STORE = Path(__file__).parent / "package" / "stored_hashes.json"


def made(items):
    """The records of a group as JSON has them."""
    return json.loads(json.dumps({name: make() for name, make in items.items()}))


def write(kept, path=STORE):
    """One item a line, so that a change is read line by line."""
    groups = [
        f"  {json.dumps(group)}: {{\n"
        + ",\n".join(f"    {json.dumps(name)}: {json.dumps(record)}" for name, record in items.items())
        + "\n  }"
        for group, items in kept.items()
    ]
    path.write_text("{\n" + ",\n".join(groups) + "\n}\n", encoding="utf-8")


def store(wanted):
    stored = json.loads(STORE.read_text(encoding="utf-8")) if STORE.exists() else {}
    kept = {}
    for group, items in GROUPS.items():
        before = stored.get(group, {})
        if group not in wanted:
            kept[group] = before
            continue
        found = made(items)
        changed = compared(before, found)
        kept[group] = {name: record if name in changed else before[name] for name, record in found.items()}
        for name in changed:
            print(f"{group}: {name}")
    write(kept)


if __name__ == "__main__":
    asked = sys.argv[1:] or list(GROUPS)
    if unknown := [group for group in asked if group not in GROUPS]:
        sys.exit(f"no group {', '.join(unknown)}; there are\n  " + "\n  ".join(GROUPS))
    warnings.simplefilter("error")
    store(asked)
