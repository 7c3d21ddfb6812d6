"""The page in the browser: the viser server, the messages to it, and who may connect."""

from ulna.viewer.page.page import Page as Page
