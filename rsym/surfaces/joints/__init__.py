"""Where patches meet: joining them, and how smooth their joints are."""
