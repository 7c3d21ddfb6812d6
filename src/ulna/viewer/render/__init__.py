"""Pictures of a scene with NumPy alone: rasterisation, lighting, shadows, textures and labels."""

from ulna.viewer.render.renderer import render as render
