"""Lines over a convex domain: what the operators of `rsym.surfaces.projections` stand on.

In come lines, as SymPy or numbers, and a domain, as a shape or corners; out go chords and crossings, exact if all is.

lines.py          straight lines, their chords, and where two cross: any two must, in the domain
domain_chords.py  where a line crosses the domain: by algebra, or with intervals that overlook no root
"""
