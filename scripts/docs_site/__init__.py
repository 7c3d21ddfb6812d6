"""The documentation site: what its pages hold, how their code runs, and how Sphinx gets them.

| module | content |
|---|---|
| `pages` | the pages and their code blocks, links and pictures |
| `execution` | runs the blocks of a page in order, and keeps what they print and which files they write |
| `staging` | the pages as Sphinx reads them: with outputs, pictures, films and notebooks |
| `notebooks` | a page as a Jupyter notebook |
| `reference` | a page of the reference for each public module |
| `built` | what is wrong with the built site: links, anchors, anything that is loaded from elsewhere |
"""
