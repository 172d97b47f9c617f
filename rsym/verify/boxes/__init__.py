"""One box: what the boundary is made of there, proved by balls and by algebra.

In comes a model and a box; out go the leaves that can be zero on it, whether they are analytic, how they are joined,
where two of them meet.

1. `local` encloses nodes on a box; `domains` says where they are defined, `generators` where they are analytic,
   `borders` whether a point lies within the bounds, `krawczyk` where equations have one common zero,
   `vectors` what a report says of balls.
2. By algebra: `polynomials`, `cyclotomic`, `constants`, `vanishing`, `contact_relations`.
3. What the boundary is: `locus` of one leaf or two, `sheets` of many; `resolution`, `classes`, `folding` and
   `root_classes` of a leaf with branches.
4. Where two sheets meet: `joints`, `touching`, `edges` (`lifting`); where omega jumps: `breaks`.
5. Of boxes left over: `holes` says where denominators vanish, `lacking` what was missing.
"""
