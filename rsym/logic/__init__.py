"""The sign of a formula: its sign form, its leaves and their names."""
