"""The model language, text to SymPy: tokens, a syntax tree, formulas; text is never run.

Text comes in; a `Shape` goes out, or an error with line and column. And back: a shape goes out as text.

- `vocabulary`: words with a meaning of their own; `functions`, `nodes`, `pieces`: what formulas may call
- `scanner`, `cursor`: text to tokens; `expressions`, `parser`: tokens to the tree of `syntax`; `matlab`: what is passed
  over; `loops` unrolled
- `declarations`, `model`: what each statement declares, every name once
- `exact`, `extent`: numbers and work bounded before SymPy sees them; `parts`: what is built; `building`, `verbatim`:
  the tree to SymPy; `assembly`: a shape of it; `loading`: from a file
- `sentences`, `writing`: a shape as text that loads to the same; `listing`: the formulas of a file as LaTeX
"""
