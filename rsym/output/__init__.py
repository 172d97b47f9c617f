"""Arrays to pictures, pages and files; widgets.

In come shapes, meshes, patches, sections and reports; out go matplotlib artists and figures, and bytes. Every picture
takes `ax=` or a figure and returns its artist.

files.py, formats.py, units.py                     meshes to files: a row per format, lengths
interactive.py, viewing.py                         the page that turns; the browser
exchange.py, dxf.py, models.py, points.py          other packages' meshes; curves; model files, letters; measured points
field_data.py                                      solutions at the points of cells that fill their shapes
looks.py, panels.py, fields.py, sign_pictures.py   level lines: looks, one panel, what users call, several; signs
boundaries.py, modes.py, torsion.py                solutions: named boundaries, sheets of modes, stress lines
deformations.py                                    elastic bodies as they are bent, with their stress
shading.py, rasteriser.py, ink.py                  bodies: light and normals, triangles to pixels, lines
paints.py, parts.py                                what a surface is painted with: a row per map; parts
axes3d.py, bodies.py, surfaces.py, gallery.py      three-dimensional axes, bodies on them, a mesh, many of them
cameras.py, sights.py, edges.py, brushes.py        rays: where the eye is, what is seen, where it ends, its colours
castings.py                                        a shape on three-dimensional axes, without a mesh
shadows.py, rendering.py, images.py, image_axes.py pictures of rays, straight from the equation, no mesh
tessellation.py, patches.py, joins.py              parametric surfaces, one or several; where they meet
sections.py, sweep.py, systems.py                  stacks of sections, one letter, R-systems side by side
certificates.py, combs.py, singular.py             the parts of verdicts: proofs and defects, teeth, edges
verdicts.py, body_verdicts.py                      verdicts as figures, in the plane and in space
atlas.py, repairs.py, fairness.py, designs.py      an atlas, a repair, fairness, designs
fits.py                                            letters and data: residuals, the speed of a boundary
cards.py, equations.py, pictures.py                small pictures with formulas, LaTeX, figures to files
design/                                            a page of a shape with live letters, served or in a file
views.py, explorer.py, explore.py                  exploring in a notebook; needs ipywidgets
solution_explorer.py                               the same of solutions
"""
