"""Arrays to pictures, pages and files; widgets.

In come shapes, meshes, patches, sections and reports; out go matplotlib artists and figures, and bytes. Every picture
takes `ax=` or a figure and returns its artist.

files.py, formats.py, units.py                     meshes to files: a row per format, lengths
interactive.py, viewing.py                         the page that turns; the browser
exchange.py, field_data.py                         other packages' meshes; solutions on cells that fill their shapes
layers.py, dxf.py, models.py, points.py            lines in a plane, curves; model files, letters; measured points
looks.py, panels.py, fields.py, sign_pictures.py   level lines: looks, one panel, what users call, several; signs
boundaries.py, modes.py, torsion.py                solutions: named boundaries, sheets of modes, stress lines
deformations.py, fits.py                           bent bodies with their stress; letters and data: residuals, speeds
shading.py, rasteriser.py, ink.py                  bodies: light and normals, triangles to pixels, lines
paints.py, parts.py                                what a surface is painted with: a row per map; parts
axes3d.py, bodies.py, surfaces.py, gallery.py      three-dimensional axes, bodies on them, a mesh, many of them
cameras.py, framing.py, sights.py, edges.py, brushes.py  rays: the eye, the frame, what is seen, edges, colours
castings.py                                        a shape on three-dimensional axes, without a mesh
shadows.py, rendering.py, slender.py, images.py, image_axes.py pictures of rays, straight from the equation, no mesh
tessellation.py, patches.py, joins.py              parametric surfaces, one or several; where they meet
sections.py, sweep.py, systems.py                  stacks of sections, one letter, R-systems side by side
certificates.py, combs.py, singular.py             the parts of verdicts: proofs and defects, teeth, edges
verdicts.py, body_verdicts.py                      verdicts as figures, in the plane and in space
atlas.py, repairs.py, fairness.py, designs.py      an atlas, a repair, fairness, designs
cards.py, equations.py, pictures.py                small pictures with formulas, LaTeX, figures to files
design/                                            a page of a shape with live letters, served or in a file
explore.py, views.py, explorer.py, solution_explorer.py  exploring in a notebook; needs ipywidgets
"""
