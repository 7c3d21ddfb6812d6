"""Other forms in which functions are evaluated: in all SIMD lanes, column by column, in stages."""
