"""Arrays to pictures, pages and files; widgets.

In come shapes, meshes, patches, sections and reports; out go matplotlib artists and figures, and bytes. Every picture
takes `ax=` or a figure and returns its artist.

files.py, formats.py, units.py, atomic.py          meshes to files: a row per format, lengths, whole or not at all
corners.py, interactive.py, viewing.py             one normal per vertex; the page that turns; the browser
exchange.py, dxf.py, models.py, presets.py         other packages' meshes; curves; model files; values of letters
looks.py, panels.py, sheet.py, fields.py           level lines: looks, one panel, several, what users call
shading.py, rasteriser.py, ink.py                  bodies: light, triangles to pixels, lines
paints.py, parts.py                                what a surface is painted with: a row per map; parts
axes3d.py, surfaces.py, gallery.py                 three-dimensional axes, a mesh on them, many of them
tessellation.py, patches.py, comparison.py, joins.py  parametric surfaces; several; where they meet
sections.py, sweep.py, systems.py                  stacks of sections, one letter, R-systems side by side
certificates.py, magnified.py, combs.py, singular.py  the parts of verdicts: proofs, defects, teeth, edges
verdicts.py, body_verdicts.py                      verdicts as figures, in the plane and in space
atlas.py, repairs.py, fairness.py, designs.py      an atlas, a repair, fairness, designs
portraits.py, cards.py, equations.py, pictures.py  small pictures, cards with formulas, LaTeX, figures to files
views.py, controls.py, explorer.py, explore.py     exploring in a notebook; needs ipywidgets
"""
