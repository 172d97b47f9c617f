"""The commands of `rsym`, one module each: `add` describes it, `run` does it.

In come words typed at a terminal; out go files, lines and an exit code. A module that names its `GROUP` is a command,
under its own name; `run` imports what it needs, so that `rsym --help` answers at once.

options.py                           what commands share: a model with letters, cells, sections, bars of progress
field_options.py                     and those that solve equations
fit.py, letters.py, models.py, show.py, source.py  models
design.py, fields.py, render.py, sections.py, sweep.py  pictures
mesh.py, view.py                     meshes
measure.py, modes.py, solve.py, torsion.py  fields on shapes
compare.py, lint.py, repair.py, verify.py  proofs
reproduce.py                         the paper
"""
