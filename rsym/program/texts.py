"""How a primitive operation is written in other languages: its cell `texts`, one entry a language.

``{0}``, ``{1}`` stand for the names or numbers of the arguments; a negative number comes in parentheses. A text is
what stands to the right of an equals sign. Names that begin with rsym_ are functions that the row of the language in
`rsym.backends.dialects` defines, where the language has none with the values of NumPy: NaN outside of the domain.
"llvm" is no language here but what `rsym.backends.llvm_code` makes instructions of. "vm" lacks what has no text.
"""

from __future__ import annotations

# Those whose arithmetic and comparisons are spelt alike.
INFIX = ("numpy", "c", "javascript", "matlab", "fortran", "rust", "julia", "cuda", "glsl")


def infix(text: str, llvm: str, vm: str, **others: str) -> dict[str, str]:
    """Arithmetic: the same text nearly everywhere.

    Examples
    --------
    >>> infix("{} * {}", "fmul {type} {0}, {1}", "mul {} {}", matlab="{} .* {}")["matlab"]
    '{} .* {}'
    """
    return {**dict.fromkeys(INFIX, text), "llvm": llvm, "vm": vm, **others}


def call(name: str, arity: int = 1, *, llvm: str = "function", **others: str) -> dict[str, str]:
    """A function of the mathematical library; `others` give its name, or a whole text, where that is another.

    Examples
    --------
    >>> texts = call("atan2", 2, numpy="arctan2")
    >>> texts["numpy"], texts["rust"], texts["vm"]
    ('numpy.arctan2({}, {})', '{}.atan2({})', 'atan2 {} {}')
    """
    several = ", ".join(["{}"] * arity)
    prefixes = {"numpy": "numpy.", "javascript": "Math."}
    texts = {}
    for language in INFIX:
        word = prefixes.get(language, "") + others.get(language, name)
        texts[language] = others[language] if "{" in word else f"{word}({several})"
    if "{" not in others.get("rust", ""):
        texts["rust"] = f"{{}}.{others.get('rust', name)}({', '.join(['{}'] * (arity - 1))})"
    texts["llvm"] = llvm
    words = others.get("vm", name)
    return {**texts, "vm": " ".join([words, *["{}"] * arity])} if words else texts


def choice(test: str, yes: str, no: str, **others: str) -> dict[str, str]:
    """One of two values; `test` compares as C does, of `or` there is none.

    Examples
    --------
    >>> choice("{0} > {1}", "{2}", "{3}")["fortran"]
    'merge({2}, {3}, {0} > {1})'
    """
    chosen = f"{test} ? {yes} : {no}"
    return {
        "numpy": f"numpy.where({test}, {yes}, {no})",
        **dict.fromkeys(("c", "javascript", "cuda", "glsl"), chosen),
        "matlab": f"rsym_select({test}, {yes}, {no})",
        "fortran": f"merge({yes}, {no}, {test})",
        "rust": f"if {test} {{{{ {yes} }}}} else {{{{ {no} }}}}",
        "julia": f"ifelse({test}, {yes}, {no})",
        "llvm": "choice",
        **others,
    }
