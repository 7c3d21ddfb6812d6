"""Pictures of a scene without a graphics card: rasterisation, lighting, shadows, textures and labels."""

from ulna.viewer.render.renderer import render as render
