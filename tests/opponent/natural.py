"""Bodies of the kind a designer or a researcher makes, put to the question: python tests/opponent/natural.py.

The truth is derived by hand from how a body is made: its grade, where the hand reaches that far. Of each the verdict,
the seconds by the clock and of the processor, and what is false; at the end how many stay without a verdict.
"""

from __future__ import annotations

import argparse
import collections
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import rsym
from opponent import natural_cut, natural_round
from opponent.truth import rank

BODIES = natural_cut.BODIES | natural_round.BODIES
LIMIT = 60.0  # seconds for one body
QUICK = ("dome", "octahedron", "edge in Rho", "ball far off", "saddle", "chimney", "vase cut", "ogive", "drop")


def falsehoods(report, grade: str | None) -> list[str]:
    """What a report says that contradicts the grade of a body; one that is no manifold is never certified."""
    said, verdict = report.continuity, report.verdict
    if grade is None or verdict == "UNDECIDED":
        return []
    if grade == "broken":
        return [f"CERTIFIED {said}, the boundary is broken"] if verdict == "CERTIFIED" else []
    expected = "CERTIFIED" if rank(grade) >= rank("G2") else "REFUTED"
    found = [f"{verdict}, the truth is {grade}"] if verdict != expected else []
    if verdict == "CERTIFIED" and rank(said) > rank(grade):
        found.append(f"continuity {said}, the truth is {grade}")
    if verdict == "REFUTED" and said != grade:
        found.append(f"continuity {said}, the truth is {grade}")
    return found


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="part of the name of a body")
    parser.add_argument("--jobs", type=int, default=1, choices=[1], help="one process: seconds are compared")
    given = parser.parse_args()
    rsym.verify_smoothness(rsym.sphere(1), method="space")  # what is compiled once is compiled now
    words, clock, processor, false = collections.Counter(), [], [], 0
    for name, (make, grade) in BODIES.items():
        if given.only not in name:
            continue
        begin, worked = time.perf_counter(), time.process_time()
        report = rsym.verify_smoothness(make(), timeout=LIMIT)
        clock.append(time.perf_counter() - begin)
        processor.append(time.process_time() - worked)
        wrong = falsehoods(report, grade)
        words[report.verdict] += 1
        false += bool(wrong)
        print(
            f"{name:30} {report.verdict:10} {report.continuity:9} {clock[-1]:6.1f} s {processor[-1]:6.1f} s processor",
            "  FALSE: " * bool(wrong) + "; ".join(wrong),
            flush=True,
        )
    count = len(clock)
    print(f"{count} bodies, {dict(words)}, without a verdict {100 * words['UNDECIDED'] / count:.1f} %, {false} false")
    for name, seconds in (("clock", clock), ("processor", processor)):
        middle, most = np.percentile(seconds, [50, 90])
        print(f"{name:10} median {middle:.2f} s, 90 % within {most:.2f} s, at most {max(seconds):.2f} s")
    return 1 if false else 0


if __name__ == "__main__":
    sys.exit(main())
