"""Old import paths of the viewer: `ulna.viewer.camera` still imports what is in `ulna.viewer.graph.camera` now."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, final

_PACKAGE = "ulna.viewer"

MODULES: dict[str, tuple[str, ...]] = {
    "assigned": ("attributes",),
    "build": ("page.viser_nodes", "page.viser_paths"),
    "camera": ("graph.camera",),
    "channel": ("page.server", "page.pose_channel"),
    "choices": ("panel.choices",),
    "client": ("page.client_files",),
    "coarse": ("mesh.vertex_clustering",),
    "companions": ("robot.overlays", "robot.robot_instances", "graph.arrow"),
    "content": ("graph.content",),
    "controls": ("page.gizmo", "page.poses"),
    "decimate": ("mesh.decimation",),
    "dials": ("robot.slider_coordinates",),
    "drawing": ("scene.annotations",),
    "ellipsoids": ("robot.ellipsoids",),
    "figure": ("robot.robot_visual", "robot.robot_instances", "robot.configuration"),
    "files": ("output.atomic_file",),
    "film": ("output.video",),
    "follow": ("robot.target_following",),
    "gather": ("render.world_triangles",),
    "glb": ("mesh.gltf",),
    "ground": ("render.ground",),
    "guard": ("page.access",),
    "handles": ("graph.handles", "graph.arrow"),
    "hold": ("page.keep_open",),
    "html": ("page.html_file",),
    "light": ("render.lighting",),
    "links": ("robot.link_surfaces",),
    "look": ("page.surroundings",),
    "mesh_store": ("mesh.mesh_cache",),
    "meshes": ("mesh.mesh_files",),
    "node": ("graph.node",),
    "pendant": ("panel.teach_panel",),
    "places": ("scene.registry",),
    "plot": ("panel.plot",),
    "png": ("output.png",),
    "publisher": ("page.publisher",),
    "raster": ("render.renderer",),
    "robot_handle": ("robot.robot_handle",),
    "screen": ("page.browser",),
    "sliders": ("panel.sliders",),
    "smooth": ("mesh.vertex_normals",),
    "stage": ("scene.objects", "scene.shapes"),
    "sticks": ("robot.stick_figure",),
    "studio": ("export",),
    "surface": ("mesh.surface",),
    "tessellate": ("mesh.primitives",),
    "texels": ("render.textures",),
    "theme": ("graph.theme",),
    "timeline": ("panel.timeline",),
    "tour": ("robot.joint_sweep",),
    "trail": ("robot.frame_path",),
    "view": ("render.projection",),
    "waiting": ("page.notifications",),
    "widgets": ("panel.controls",),
    "words": ("render.labels",),
    "zbuffer": ("render.zbuffer",),
}
"""The modules that hold what an old module held, by the name of the old one."""

NAMES: dict[str, str] = {
    "AROUND": "FACETS",
    "Assigned": "FixedAttributes",
    "Boxes": "RadioBoxes",
    "Client": "ClientFiles",
    "Cloud": "PointCloud",
    "Companions": "RobotOverlays",
    "Crowd": "Instances",
    "Dial": "SliderCoordinate",
    "Drawing": "AnnotationMethods",
    "Figure": "RobotVisual",
    "File": "ServedFile",
    "Followed": "FollowStep",
    "Follower": "TargetFollower",
    "Ghosts": "RobotInstances",
    "GhostsHandle": "RobotInstancesHandle",
    "HEAVY": "CLUSTERING_THRESHOLD",
    "INKS": "LINE_COLOURS",
    "INSET": "TRANSLUCENT_INSET",
    "KEY": "KEY_DIRECTION",
    "KNOWN": "KNOWN_VERSIONS",
    "Kept": "OfflineHandle",
    "LAMP": "KEY_LIGHT",
    "LOOKS": "APPEARANCES",
    "Labelled": "DisableableControl",
    "Menu": "ButtonMenu",
    "Motion": "HandleMotion",
    "Moved": "MovableRobot",
    "Named": "LabelledControl",
    "PACE": "SPEED_EXPECTED",
    "PLAIN": "DEFAULT_SHAPE_COLOUR",
    "Path": "Polyline",
    "Paths": "ViserPaths",
    "Pendant": "TeachPanel",
    "Places": "HandleRegistry",
    "Recorded": "Playable",
    "SHOWINGS": "ROBOT_DISPLAYS",
    "Showing": "RobotDisplay",
    "Shown": "ViserNode",
    "Stage": "SceneMethods",
    "Studio": "ExportMethods",
    "Trail": "FramePath",
    "UNSEEN": "MAX_DEVIATION",
    "Valued": "ValueControl",
    "View": "Projection",
    "Waiting": "ProgressNotifications",
    "Words": "Label",
    "allowed": "is_allowed",
    "answer": "response_to",
    "build": "add_node",
    "check_even": "check_uniform_scale",
    "check_film": "checked_video_path",
    "checked_height": "checked_floor",
    "checked_page": "checked_html_path",
    "checked_picture": "checked_png_path",
    "checked_showing": "checked_display",
    "choices": "checked_choices",
    "coarse": "clustered",
    "colours": "sample_texture",
    "cookie": "token_cookie",
    "decorate": "configure_scene",
    "dials": "slider_coordinates",
    "digits": "decimals",
    "display": "tone_mapped",
    "dress_rows": "appearance_rows",
    "entry": "cache_key",
    "frame": "camera_for",
    "frames": "frame_ancestors",
    "gather": "world_triangles",
    "gif_times": "gif_frame_durations",
    "hold": "keep_open",
    "is_clear": "is_translucent",
    "joined": "joined_by_colour",
    "known": "is_known_version",
    "knows": "has_token",
    "lay_floor": "add_floor",
    "link_looks": "surfaces_by_link",
    "look_from": "set_camera",
    "look_of": "appearance_of",
    "moments": "frame_times",
    "of_inertias": "inertia_ellipsoids",
    "of_jacobian": "manipulability_ellipsoid",
    "paint": "albedo",
    "png": "encode_png",
    "read": "read_cached",
    "shades": "colour_values",
    "smooth": "surface_with_normals",
    "srgb": "srgb_from_linear",
    "standing": "pose_or_position",
    "through": "delegated_property",
    "tour": "joint_sweep",
    "unit": "normalized",
    "unpacked": "unpacked_parts",
    "weld": "merged_vertices",
    "words_glb": "label_glb",
    "write": "write_cached",
    "write_film": "write_video",
    "write_words": "draw_labels",
    "written": "atomic_write",
}
"""New names of classes and functions, by their old names."""


@final
class RenamedModules(MetaPathFinder, Loader):
    """Finds old modules of the viewer; their attributes are those of the new ones."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of an old module; None for all others.

        Args:
            fullname: Name of the module.
            path: Not used; see `importlib.abc.MetaPathFinder`.
            target: Not used.

        Returns:
            The spec, or None.
        """
        package, _, name = fullname.rpartition(".")
        return ModuleSpec(fullname, self) if package == _PACKAGE and name in MODULES else None

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """None: an ordinary module."""
        return None

    def exec_module(self, module: ModuleType) -> None:
        """Have the module look attributes up in the new modules."""
        modules = [
            importlib.import_module(f"{_PACKAGE}.{new}")
            for new in MODULES[module.__name__.rpartition(".")[2]]
        ]

        def attribute(name: str) -> Any:
            for key in (NAMES.get(name, name), name):
                for new_module in modules:
                    if key in vars(new_module):
                        return vars(new_module)[key]
            raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")

        module.__getattr__ = attribute  # type: ignore[method-assign]


def install() -> None:
    """Have Python find the old modules, after all others."""
    if not any(isinstance(finder, RenamedModules) for finder in sys.meta_path):
        sys.meta_path.append(RenamedModules())
