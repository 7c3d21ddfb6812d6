"""The language and its graph: what a traced function is, how it is simplified, interpreted and differentiated."""
