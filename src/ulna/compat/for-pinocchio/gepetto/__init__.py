"""Gepetto viewer's interface on Ulna's viewer: its clients, its calls, its names; what is drawn is drawn by Ulna."""

from gepetto.color import Color as Color
