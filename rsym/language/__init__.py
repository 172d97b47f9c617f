"""The model language, text to SymPy: tokens, a syntax tree, formulas; text is never run.

Text comes in; a `Shape` goes out, or an error with line and column. And back: a shape goes out as text.

- `functions`, `pieces`: what formulas may call
- `scanner`: text to tokens; `expressions`, `parser`: tokens to the tree of `syntax`, loops unrolled
- `equations`, `conditions`: differential equations to two such trees, conditions on the boundary to theirs
- `model`: what each statement declares, every name once
- `exact`, `extent`: numbers and work bounded before SymPy sees them; `building`: the tree to SymPy; `assembly`: a shape
  of it; `loading`: from a file
- `stating`: what a file says of a function on its shape
- `vm`: the plain text of fidget and MPR, line by line to a shape
- `sentences`, `writing`: a shape as text that loads to the same; `listing`: the formulas of a file as LaTeX
"""
