"""The target "object": object files for other processors, with the header of the target "c".

| module | content |
|---|---|
| `processors.py` | the table of processors |
| `searches.py` | the function around a search, which checks its arguments |
| `symbols.py` | what an object file needs from elsewhere |
| `folder.py` | the files |
"""
