"""Links: their transforms, dynamic parameters, shapes, grippers, and the tree that they form."""
