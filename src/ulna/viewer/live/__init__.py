"""The live page: a robot as one HTML file, with its kinematics in WebAssembly, that browsers open without a server.

Read in this order:

| module | content |
|---|---|
| `save.py` | `robot.save_html`: the arguments, the file |
| `page.py` | the parts of a page, and how they become HTML or a script |
| `description.py`, `draggable.py` | sliders, frames to drag and the joints that follow them, as plain data |
| `kinematics.py` | the kernels of a page, as a WebAssembly module |
| `mesh_packing.py`, `triangle_codes.py` | meshes: simplified, rounded, compressed |
| `motion.py`, `poster.py`, `credits.py` | what is played, the first picture, licences |
| `js` | the program of the page: `main.js`, `element.js` first |
| `bundle` | the same with three.js, as scripts/live_page_bundle.py makes it |
"""

from ulna.viewer.live.save import save_html as save_html
