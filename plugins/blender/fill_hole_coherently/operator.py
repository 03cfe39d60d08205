# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator: from the menu on a thread with progress and Esc, from scripts and the redo panel at
once."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from . import guidance, mesh_data, session
from .complete_mesh import Cancelled, CompleteMeshError, LibraryNotFound, Status

# Shown to the user; anything else is a fault of the add-on, and Blender shows where.
TROUBLES = (CompleteMeshError, LibraryNotFound, session.NothingToFill)
# Events that move the view; all others wait until the fill is there.
VIEW_EVENTS = {"MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN", "TRACKPADZOOM"}


class MESH_OT_fill_hole_coherently(guidance.Guided, bpy.types.Operator):
    """Fill holes so that the fill continues the shape and relief that the rest of the object shows"""

    bl_idname = "mesh.fill_hole_coherently"
    bl_label = "Fill Hole Coherently"
    bl_options = {"REGISTER", "UNDO"}

    method: EnumProperty(
        name="Method",
        items=[
            (
                "COHERENT",
                "Coherent",
                "Continue what the object shows elsewhere; smooth where nothing on it serves",
            ),
            ("SMOOTH", "Smooth", "Continue the surface around the hole, without relief; quick"),
        ],
        default="COHERENT",
    )
    density: FloatProperty(
        name="Density",
        description="Vertices along an edge, relative to the surroundings: 2 makes triangles half "
        "as long as around the hole",
        default=1.0,
        min=0.05,
        max=20.0,
        soft_min=0.25,
        soft_max=4.0,
    )
    max_edges: IntProperty(
        name="Max Hole Size",
        description="Leave holes open that have more boundary edges; 0 for no limit",
        default=0,
        min=0,
    )
    keep_largest_open: BoolProperty(
        name="Keep Largest Open",
        description="Leave the longest hole open: the border of a scan or of a flat piece",
        default=False,
    )
    join_loops: BoolProperty(
        name="Join Facing Loops",
        description="Fill loops that face each other together: the two ends of a missing band, "
        "islands in a hole. Off: close every loop on its own",
        default=True,
    )
    skip_unsafe: BoolProperty(
        name="Skip Unsafe",
        description="Leave holes open that cannot be filled, and fill the others. Off: fill none, "
        "and select what is in the way",
        default=False,
    )
    match_colors: BoolProperty(
        name="Match Colors",
        description="The active color attribute helps to find the place to copy from. Off: the shape "
        "alone decides. Colors and other attributes are copied with the shape either way",
        default=True,
    )
    write_attributes: BoolProperty(
        name="Write Attributes",
        description="Keep in the mesh which faces are new (completed), and for each new vertex the "
        "face it was copied from (completion_source) and a confidence (completion_confidence)",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        ob = context.active_object
        if ob is None or ob.type != "MESH" or context.mode not in {"OBJECT", "EDIT_MESH"}:
            cls.poll_message_set("Needs an active mesh object in Object Mode or Edit Mode")
            return False
        if ob.data.library is not None:
            cls.poll_message_set("The mesh is linked from another file")
            return False
        return True

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "method")
        layout.prop(self, "density")
        self.draw_guidance(context, layout)
        layout.prop(self, "match_colors")
        column = layout.column(heading="Holes")
        column.prop(self, "max_edges")
        column.prop(self, "keep_largest_open")
        column.prop(self, "join_loops")
        column.prop(self, "skip_unsafe")
        layout.prop(self, "write_attributes")

    def _arguments(self, ob, arrays):
        """What session.fill takes, and what the mesh carries."""
        others = self.others(ob)
        carried = mesh_data.Carried(ob, arrays, self.match_colors, others, self.of_others_alone)
        options = session.Options(
            method=self.method.lower(),
            density=self.density,
            max_edges=self.max_edges,
            keep_largest_open=self.keep_largest_open,
            join_loops=self.join_loops,
            skip_unsafe=self.skip_unsafe,
            mirror=self.mirror,
            all_if_untouched=self.source == "SELECTED",
            is_cloud=arrays.is_cloud,
            normals=carried.normals,
            sources=self.sources(ob, arrays, others),
            values=carried.asked.arguments,
            guidance=self.guidance(ob, others),
            points=self.points(ob),
            rims=self.rims(ob, arrays),
        )
        return (arrays.vertices, arrays.triangles, arrays.selected, options), carried

    def execute(self, context):
        """Blocks: for scripts, and for the redo panel, which has the mesh as it was before."""
        ob = context.active_object
        arrays = mesh_data.read(ob)
        try:
            arguments, carried = self._arguments(ob, arrays)
            return self._finish(ob, arrays, carried, session.fill(*arguments))
        except TROUBLES as error:
            return self._fail(context, ob, arrays, error)

    def invoke(self, context, _event):
        if context.window is None or bpy.app.background:
            return self.execute(context)
        ob = context.active_object
        self._name, self._mode = ob.name, ob.mode
        self._arrays = mesh_data.read(ob)
        try:
            arguments, self._carried = self._arguments(ob, self._arrays)
        except TROUBLES as error:
            return self._fail(context, ob, self._arrays, error)
        self._job = session.Job(*arguments)
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(0.05, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancelled = True
        elif event.type in VIEW_EVENTS:
            return {"PASS_THROUGH"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}  # the mesh must stay as it is
        self._show(context)
        if self._job.is_running:
            return {"RUNNING_MODAL"}
        self._clean_up(context)
        return self._take(context)

    def cancel(self, context):
        """Blender quits or loads another file."""
        self._job.stop()
        self._clean_up(context)

    def _show(self, context):
        job = self._job
        context.window_manager.progress_update(int(job.fraction * 100))
        what = "cancelling" if job.cancelled else f"{job.stage}, Esc cancels"
        context.workspace.status_text_set(f"Fill Hole Coherently: {job.fraction:4.0%}   {what}")

    def _clean_up(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _take(self, context):
        """The job is done: into the mesh with it, if that is still the one that it is for."""
        ob = bpy.data.objects.get(self._name)
        now = mesh_data.read(ob) if ob and ob.type == "MESH" and ob.mode == self._mode else None
        was = self._arrays
        if now is None or session.content_hash(now.vertices, now.triangles) != session.content_hash(
            was.vertices, was.triangles
        ):
            self.report({"ERROR"}, "The mesh was changed meanwhile: nothing was filled")
            return {"CANCELLED"}
        try:
            if self._job.error is not None:
                raise self._job.error
            return self._finish(ob, was, self._carried, self._job.result)
        except TROUBLES as error:
            return self._fail(context, ob, was, error)

    def _finish(self, ob, arrays, carried, result):
        if not result.filled_count:
            reasons = {hole.reason for hole in result.holes if hole.reason}
            self.report({"WARNING"}, f"No hole could be filled: {'; '.join(sorted(reasons))}")
            return {"CANCELLED"}
        missed = mesh_data.add_fill(ob, result, arrays, carried, self.write_attributes)
        for name in missed:
            self.report({"WARNING"}, f"The mesh has another attribute {name}, which was left alone")
        for text in warnings(result.holes):
            self.report({"WARNING"}, text)
        self.report({"INFO"}, summary(result))
        return {"FINISHED"}

    def _fail(self, context, ob, arrays, error):
        if isinstance(error, Cancelled):
            self.report({"INFO"}, "Cancelled: the mesh is as it was")
            return {"CANCELLED"}
        if isinstance(error, session.NothingToFill):
            self.report({"WARNING"}, str(error))
            return {"CANCELLED"}
        vertices, edges, polygons = in_the_way(error, arrays)
        if len(vertices) or len(edges) or len(polygons):
            mesh_data.select(ob, vertices, edges, polygons)
            if ob.mode == "EDIT" and (len(vertices) or len(edges)):
                context.tool_settings.mesh_select_mode = (True, False, False)
        self.report({"ERROR"}, in_words(error))
        return {"CANCELLED"}


def in_the_way(error, arrays):
    """Vertices, edges and polygons to select for an error: those that it names; or the rims of the
    holes that it names."""
    if not isinstance(error, CompleteMeshError):
        return (), (), ()
    vertices, edges, polygons = error.vertices, error.edges, arrays.polygons[error.faces]
    if not (len(vertices) or len(edges) or len(polygons)) and hasattr(error, "rims"):
        edges = error.rims
    return vertices, edges, np.unique(polygons)


def in_words(error):
    text = str(error)
    text = text[:1].upper() + text[1:]
    if isinstance(error, CompleteMeshError) and error.status in (
        Status.UNSAFE_HOLE,
        Status.HOLE_FAILED,
    ):
        # After the semicolon the library says what its own options do.
        text = f"{text.rsplit(';', 1)[0]}. It is selected; Skip Unsafe leaves it open and fills the others"
    return text


def summary(result):
    filled = [hole for hole in result.holes if hole.status == "filled"]
    skipped = sum(hole.status in ("unsafe", "failed") for hole in result.holes)
    smooth = sum(hole.method == "smooth" for hole in filled)
    new = count(len(result.new_points), "point") if is_of_points(result) else count(len(result.new_faces), "face")
    text = f"Filled {count(len(filled), 'hole')} with {new}"
    confidences = [f"{hole.confidence:.2f}" for hole in filled if hole.method != "smooth"]
    if confidences:
        text += f", confidence {' to '.join(sorted({min(confidences), max(confidences)}))}"
        if smooth:
            text += f"; {smooth} smooth, for nothing on the object served"
    if skipped:
        text += f"; {count(skipped, 'hole')} left open as unsafe"
    return text


def is_of_points(result):
    return not hasattr(result, "new_faces")


def warnings(holes):
    for kind, what in (("outlier", "beside the surface"), ("duplicate", "at the place of another")):
        if len(holes.ignored_points[kind]):
            text = f"{count(len(holes.ignored_points[kind]), 'point')} {what} not looked at"
            yield text.replace("not looked", "was not looked" if text.startswith("1 ") else "were not looked")
    if len(holes.duplicate_vertices):
        yield (
            f"{count(len(holes.duplicate_vertices), 'pair')} of rim vertices at one place: what looks "
            "closed there is open. Merge by Distance welds it"
        )
    if len(holes.inconsistent_edges):
        yield (
            f"Faces disagree about their outside at {count(len(holes.inconsistent_edges), 'edge')}. "
            "Recalculate Outside mends it"
        )


def count(number, word):
    return f"{number} {word}" if number == 1 else f"{number} {word}s"
