"""Methods of a robot that are no kernels: searches, collision, and robots made of it; and former names."""
