"""The robots that can be loaded by name: those written down here, and where to find the others."""
