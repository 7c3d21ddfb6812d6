"""The book: one algorithm a file, free pure functions of a model and numbers, symbols or traced scalars.

Every file opens with its table of symbols. Page references: Featherstone, Rigid Body Dynamics Algorithms (2008);
Lynch & Park, Modern Robotics (2017); Siciliano et al., Robotics: Modelling, Planning and Control (2009).
"""
