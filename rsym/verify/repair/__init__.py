"""From verdict to design again: the smallest changes of a shape that make its boundary curvature-continuous."""
