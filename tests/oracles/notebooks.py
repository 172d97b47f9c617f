"""Notebooks as the JSON that they are: the package that validates them takes seconds to load."""

import json
import re
import sys
from pathlib import Path

NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")
RESULT = re.compile(r"^Out\[\d+\]:\s*(<Figure.*)?", re.MULTILINE)  # what a shell without pages puts before results
ROUNDING = 1e-11  # printed numbers as small as that are other ones on each processor


def read(path):
    """A notebook; the source of each cell one text."""
    notebook = json.loads(path.read_text())
    for cell in notebook["cells"]:
        cell["source"] = "".join(cell["source"])
    return notebook


def stored(notebook):
    """What the code cells of a notebook printed: text and results, without pictures."""
    cells = []
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            printed = ["".join(one["text"]) for one in cell["outputs"] if one.get("name") == "stdout"]
            cells.append(printed + [shown(one.get("data", {})) for one in cell["outputs"]])
    return ["".join(texts) for texts in cells]


def run(path):
    """What they print when they are run, in this process."""
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.utils.capture import capture_output

    shell, cells = InteractiveShell.instance(), []
    for cell in read(path)["cells"]:
        if cell["cell_type"] == "code":
            with capture_output() as printed:
                shell.run_cell(cell["source"], store_history=True).raise_error()
            text = RESULT.sub("", printed.stdout) + "".join(shown(one.data) for one in printed.outputs)
            cells.append(text)
    return cells


def shown(data):
    """The text of what is shown; of a figure that is its size, which fonts decide."""
    text = "".join(data.get("text/plain", ""))
    return "" if text.startswith("<Figure") else text + "\n"


def differences(one, other):
    """Where two printed texts differ: their words, or numbers by more than one in the last place."""
    if NUMBER.sub("#", one).split() != NUMBER.sub("#", other).split():
        return [(one, other)]
    pairs = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
    return [(a, b) for a, b in pairs if abs(float(a) - float(b)) > 1.001 * max(_place(a), _place(b)) + ROUNDING]


def _place(number):
    """What one in its last place is."""
    digits, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


if __name__ == "__main__":
    found = run(Path(sys.argv[1]))
    print(json.dumps(found))
