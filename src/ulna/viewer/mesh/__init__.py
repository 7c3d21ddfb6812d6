"""Triangle meshes: surfaces, primitive shapes, mesh files, normals, simplification, and glTF."""
