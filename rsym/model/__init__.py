"""What a shape is: R-nodes, systems, letters, shapes; primitives, motions, constructions, symmetry, blends, skeletons.

Numbers, points and SymPy expressions come in; a `Shape` goes out: one expression in coordinates and letters, with
bounds and named parts. In the order of the data:

- `symbols`, `vectors`: symbols real, expressions walked without recursion, vectors of expressions
- `nodes`, `powers`, `choices`, `rnodes`: what SymPy keeps whole; `systems`: nodes of logic made;
  `functions`: what else a formula may name; `rewriting`: what becomes a formula of those; `unevaluated`: nodes made as
  they stand
- `letters` and `arguments`: what a shape is given, checked once; `requirements`: what all public functions refuse alike
- `bounding`: the window that is stated, or a box that holds a shape; `equation`: the data of a shape; `motions` of it;
  `named_parts`; `logical`: operators that it has not; `shape`: `Shape`, which joins these
- `operations`: logic on shapes or expressions; `primitives/`: shapes of numbers; `constructions`,
  `symmetry/`, `blends/`: shapes of shapes; `distances`, `parallels`: leaves as functions of a distance, bodies moved
  by one, leaf by leaf; `skeletons`, with `positivity`: bodies around curves
- `recent`: what is made of a shape kept by what it is; `abridging`, `showing`: a shape as people see it;
  `wording`, `spelling`: what a message proposes and lists, and instead of American words
"""
