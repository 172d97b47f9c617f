"""The plane of two letters: where a boundary is proved smooth, where it is proved not to be, and the line between."""
