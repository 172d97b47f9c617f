"""Put many shapes to the question: python tests/opponent/hunt.py plane --count 2000 --start 0."""

from __future__ import annotations

import argparse
import collections
import importlib
import signal
import sys
import time
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

SLOW = 20  # CPU seconds after which a case is given up


class Slow(BaseException):
    """A case takes too long."""


def _give_up(*_):
    raise Slow


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "kind",
        help="plane, space, turned, made, lettered, parted, windows, thin, pictures, measures, or another beside",
    )
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--start", type=int, default=0)
    parser.add_argument("--only", default="", help="part of the name of a family")
    parser.add_argument("--verbose", action="store_true")
    given = parser.parse_args()
    family = importlib.import_module(f"opponent.{given.kind}")
    tally = collections.defaultdict(collections.Counter)
    spent = collections.Counter()
    false = 0
    signal.signal(signal.SIGVTALRM, _give_up)
    for seed in range(given.start, given.start + given.count):
        name, text, wrong, begin = "?", "", [], time.process_time()
        signal.setitimer(signal.ITIMER_VIRTUAL, SLOW)
        try:
            case = family.case(seed)
            name, text = case.family, str(case)
            if given.only not in name:
                continue
            word, wrong = family.asked(case)
        except Slow:
            word = "SLOW"
            print(f"--- seed {seed} ({name}): slow: {text[:300]}")
        except Exception:
            word = "CRASH"
            wrong = [traceback.format_exc(limit=-3)]
        finally:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        took = time.process_time() - begin
        tally[name][word] += 1
        spent[name] += took
        if given.verbose:
            print(seed, name, word, f"{took:.1f} s")
        if wrong:
            false += 1
            print(f"--- seed {seed} ({name}, {took:.1f} s): {text}")
            print("".join(f"      {line}\n" for line in wrong), end="", flush=True)
    for name, words in sorted(tally.items()):
        print(f"{name:22} {dict(words)}  {spent[name]:.0f} s")
    print(f"{false} false among {sum(sum(words.values()) for words in tally.values())}")
    return 1 if false else 0


if __name__ == "__main__":
    sys.exit(main())
