"""The target "ptx": CUDA kernels of one thread for each sample, as assembly text for NVIDIA GPUs."""
