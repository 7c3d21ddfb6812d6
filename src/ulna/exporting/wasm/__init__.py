"""The target "wasm": a WebAssembly module without imports, and a JavaScript module around it.

| module | content |
|---|---|
| `linking.py` | LLVM's relocatable object as a separate module: memory, stack and exports instead of imports |
| `code.py` | functions and searches as such a module |
| `description.py` | what the JavaScript module knows of functions and robot |
| `declarations.py` | the types, for TypeScript and editors |
| `runtime.js` | the JavaScript module: checks of arguments, calls, searches |
| `test_program.py` | a script for node with recorded values |
| `folder.py` | the files |
"""
