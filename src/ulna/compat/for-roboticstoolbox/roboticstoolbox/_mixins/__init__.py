"""Groups of methods of a robot: state, links, text, graph, copies, and its place among frames."""
