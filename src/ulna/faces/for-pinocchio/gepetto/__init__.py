"""The face of Gepetto viewer over Ulna's: its clients, its calls, its names; what is drawn is drawn by Ulna."""

from gepetto.color import Color as Color
