"""Clients of the viewer: `Client().gui` draws into the page of this process; no server is needed, none is started."""

from gepetto.color import Color as Color
from gepetto.corbaserver.client import Client as Client
from gepetto.corbaserver.client import gui_client as gui_client
from gepetto.corbaserver.client import shared_viewer as shared_viewer
from gepetto.corbaserver.client import start_server as start_server
from gepetto.corbaserver.gui import Gui as Gui
from gepetto.corbaserver.placement import quaternion_order as quaternion_order
