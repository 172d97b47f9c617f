"""Functions on shapes: what interpolates data on the boundary, what meets conditions there, and what solves equations.

A shape with named parts comes in, and conditions by the names of these; functions of the same coordinates go out.

- `conditions`: conditions by name, brought to the leaves of the shape; `interfaces`: where coefficients jump
- `meetings`: where parts of the boundary are, and where they meet; `parts`: that they are there and data agree
- `interpolation`: values and normal derivatives on parts, by one function; `solution_structures`: functions with
  undetermined ones in them that meet conditions
- `terms`: what is linear in an unknown function; `equation_text`, `equations`: a differential equation, of text or
  SymPy, as its coefficients; `weak/`: forms of u and v, written as functions, as theirs
- `pointwise`: formulas compiled, at points; `loops`: the curves of a boundary; `lifts`: functions with values there
- `switches`: conditions that change on an edge; `even_switches`: by functions that grow evenly along it
- `seams/`: a shape whose form is zero inside, where parts share an edge, written anew
- `like_slopes`: leaves for weights; `splines/`: functions on a grid; `systems/`: matrices of forms on them, and their
  answers
- `places`: rules and insides of shapes; `corners/`: what solutions have at corners; `problem`: a problem and what its
  solution is made of; `cornered`: corners in it; `posing`: its conditions as the letters of its shape have them
- `plates`: what bending needs; `galerkin`: the system of a problem; `guards`: what problems and solutions have to keep;
  `interfaces`: where coefficients jump; `refinement`: until errors are small; `estimates`: of them; `peaks`: of data,
  which a rule misses; `resonance`: what small changes become
- `sources`: with poles; `boundary_data`: values rough inside; `given_functions`: of functions; `jumps`: that jump;
  `shares`: functions that are 1 on some leaves and 0 on others; `fluxes`: what flows through parts of the boundary
- `solution`, `solution_report`: what comes out, and how it was found; `printed`: as an expression; `extremes`: its
  least value; `limits`: derivatives where a formula has none; `left_behind`: what no pickle of it holds
- `solving`, `weak_solving`, `spectra`, `torsion`: what is asked; `elastic/`: two displacements of a body in the plane;
  `stated`: what a model file asks
"""
