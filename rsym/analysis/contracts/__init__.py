"""Contracts: what every node of a formula promises, and what that comes to for a shape.

A shape comes in; a `Contract` goes out: class, order of normalisation, singular sets, leaves, interval image.

- `promises`: what one node says; `ends`: rules for intervals; `squares`: where sums of squares vanish
- `elementary`, `table`: the rules of every node, and walks that read them
- `leaves`: the parts under the logic; `orders`: to which order each is normalised, evaluated in the `algebras` of
  fractions and series, over `towers` of roots of polynomials modulo a prime
- `summary`: what all of it comes to; `display`: its words
"""
