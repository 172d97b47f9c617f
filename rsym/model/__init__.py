"""What a shape is: R-systems, R-nodes, letters, shapes and the model language."""
