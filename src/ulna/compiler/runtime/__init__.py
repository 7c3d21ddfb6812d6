"""The runtime: LLVM IR becomes machine code, NumPy's generalised ufuncs and Python callables."""
