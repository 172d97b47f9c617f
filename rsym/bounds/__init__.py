"""What a program can be on a box: intervals, balls, mean values, far forms, enclosures."""
