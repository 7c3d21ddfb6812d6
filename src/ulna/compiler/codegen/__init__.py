"""Code generation: from a graph to LLVM IR for one `Target`."""
