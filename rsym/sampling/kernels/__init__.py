"""The mesher's routines on a sign form, compiled: over boxes, blocks, edges and points."""
