"""The imperative language: restricted Python with loops, arrays and lanes, read into a typed tree and interpreted."""
