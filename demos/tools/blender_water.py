"""Renders the frames of a run with refracting water, in Blender (tried with Debian 12's 3.4: apt-get install blender).

    blender --background --python demos/tools/blender_water.py -- out/jet [options]

reads DIR/surface_NNNN.ply, .glb or .vdb (water), DIR/cloth_K_NNNN.ply and DIR/body_K_NNNN.ply, and writes
DIR/render_NNNN.png. Options:
    --water FORMAT   ply, glb or vdb: the files of the water (default: the first of them that a frame has)
    --surfaces DIR   where the files of the water are (default: DIR)
    --frames A:B     only these frames, both included (default: all that have a surface)
    --size WxH       of the picture in pixels (default 960x720)
    --samples N      light paths per pixel (default 64)
    --eye X,Y,Z --target X,Y,Z --angle DEGREES    the camera (default: from above, around everything in the first frame)
    --hide NAMES     what is left out, as body_0,cloth_1: a tank hides the water in it (default: nothing)
    --out DIR        where the pictures go (default: DIR)
Coordinates are those of the run (metres, y up unless --up says otherwise).
Without `--background` the first frame stays open in Blender, to go on from there.
"""

import argparse
import glob
import math
import os
import re
import sys

import bpy
import numpy
from mathutils import Matrix, Vector

FORMATS = ("ply", "glb", "vdb")


def vector(text):
    parts = [float(x) for x in text.split(",")]
    if len(parts) != 3:
        raise argparse.ArgumentTypeError("%r must be three numbers X,Y,Z" % text)
    return Vector(parts)


def frame_range(text):
    match = re.fullmatch(r"(\d+):(\d+)", text)
    if not match or int(match.group(1)) > int(match.group(2)):
        raise argparse.ArgumentTypeError("%r must be A:B with A <= B" % text)
    return int(match.group(1)), int(match.group(2))


def picture_size(text):
    match = re.fullmatch(r"(\d+)x(\d+)", text)
    if not match:
        raise argparse.ArgumentTypeError("%r must be WIDTHxHEIGHT" % text)
    return int(match.group(1)), int(match.group(2))


def names(text):
    found = text.split(",")
    for name in found:
        if not re.fullmatch(r"(body|cloth)_\d+", name):
            raise argparse.ArgumentTypeError("%r must be names such as body_0,cloth_1" % text)
    return found


def arguments():
    own = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="blender --background --python demos/tools/blender_water.py --")
    parser.add_argument("directory")
    parser.add_argument("--water", choices=FORMATS)
    parser.add_argument("--surfaces")
    parser.add_argument("--frames", type=frame_range)
    parser.add_argument("--size", type=picture_size, default=(960, 720))
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--eye", type=vector)
    parser.add_argument("--target", type=vector)
    parser.add_argument("--up", type=vector, default=Vector((0, 1, 0)))
    parser.add_argument("--angle", type=float, default=30)
    parser.add_argument("--hide", type=names, default=())
    parser.add_argument("--out")
    return parser.parse_args(own)


def water_files(options):
    """{number: file} of all frames with a surface."""
    found = {}
    for suffix in (options.water,) if options.water else FORMATS:
        for path in glob.glob(os.path.join(options.surfaces or options.directory, "surface_[0-9]*." + suffix)):
            number = int(re.search(r"_(\d+)\.\w+$", path).group(1))
            if not options.frames or options.frames[0] <= number <= options.frames[1]:
                found.setdefault(number, path)
    return found


def frames_in(options):
    """[(number, water file, [cloth files], [body files])] of all frames with a surface."""
    frames = []
    for number, path in sorted(water_files(options).items()):
        hidden = [os.path.join(options.directory, "%s_%04d.ply" % (name, number)) for name in options.hide]
        cloth, bodies = (sorted(path for path in glob.glob(os.path.join(options.directory, "%s_*_%04d.ply" % (kind, number)))
                                if path not in hidden)
                         for kind in ("cloth", "body"))
        frames.append((number, path, cloth, bodies))
    return frames


def import_ply(path):
    if hasattr(bpy.ops.wm, "ply_import") and bpy.app.version >= (4, 0, 0):
        bpy.ops.wm.ply_import(filepath=path, forward_axis="Y", up_axis="Z")  # as the file has it
    else:
        bpy.ops.import_mesh.ply(filepath=path)
    return bpy.context.selected_objects[0]


def import_glb(path):
    if not hasattr(numpy, "bool"):
        numpy.bool = bool  # the importer of Blender 3.4 uses a name that NumPy 1.24 no longer has
    bpy.ops.object.select_all(action="DESELECT")
    bpy.ops.import_scene.gltf(filepath=path)
    if not bpy.context.selected_objects:  # a frame without water has no scene
        return new_object(bpy.data.meshes.new("water"))
    item = bpy.context.selected_objects[0]
    item.data.transform(Matrix.Rotation(math.radians(-90), 4, "X"))  # the importer turns y up to z up
    return item


def new_object(mesh):
    item = bpy.data.objects.new("water", mesh)
    bpy.context.collection.objects.link(item)
    return item


def import_vdb(path):
    """The zero set of the grid `surface` as a mesh."""
    bpy.ops.object.volume_import(filepath=path)
    volume = bpy.context.object
    source = new_object(bpy.data.meshes.new("source"))
    modifier = source.modifiers.new("surface", "VOLUME_TO_MESH")
    modifier.object, modifier.grid_name, modifier.threshold = volume, "surface", 0
    evaluated = source.evaluated_get(bpy.context.evaluated_depsgraph_get())
    item = new_object(bpy.data.meshes.new_from_object(evaluated))
    for used in (source, volume):
        bpy.data.objects.remove(used)
    return item


def read_mesh(path, name):
    readers = {"ply": import_ply, "glb": import_glb, "vdb": import_vdb}
    item = readers[path.rsplit(".", 1)[1]](path)
    item.name = name
    item.data.materials.clear()
    for polygon in item.data.polygons:
        polygon.use_smooth = True
    return item


def shader(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    return material, nodes, material.node_tree.links, nodes.new("ShaderNodeOutputMaterial")


def water():
    """Refraction of water (1.333) with a faint blue by depth. Shadow rays pass straight through: caustics through a rough
    surface would need thousands of paths per pixel, and black shadows below clear water look wrong."""
    material, nodes, links, output = shader("water")
    glass = nodes.new("ShaderNodeBsdfGlass")
    glass.inputs["IOR"].default_value = 1.333
    glass.inputs["Roughness"].default_value = 0
    glass.inputs["Color"].default_value = (0.98, 1, 1, 1)
    through = nodes.new("ShaderNodeBsdfTransparent")
    through.inputs["Color"].default_value = (0.88, 0.95, 0.97, 1)
    path = nodes.new("ShaderNodeLightPath")
    either = nodes.new("ShaderNodeMixShader")
    links.new(path.outputs["Is Shadow Ray"], either.inputs["Fac"])
    links.new(glass.outputs["BSDF"], either.inputs[1])
    links.new(through.outputs["BSDF"], either.inputs[2])
    links.new(either.outputs["Shader"], output.inputs["Surface"])
    depth = nodes.new("ShaderNodeVolumeAbsorption")
    depth.inputs["Color"].default_value = (0.35, 0.75, 0.95, 1)
    depth.inputs["Density"].default_value = 9
    links.new(depth.outputs["Volume"], output.inputs["Volume"])
    return material


def matt(name, colour, roughness=0.85):
    material, nodes, links, output = shader(name)
    surface = nodes.new("ShaderNodeBsdfPrincipled")
    surface.inputs["Base Color"].default_value = (*colour, 1)
    surface.inputs["Roughness"].default_value = roughness
    links.new(surface.outputs["BSDF"], output.inputs["Surface"])
    return material


def bounds(items):
    corners = [item.matrix_world @ Vector(c) for item in items for c in item.bound_box]
    low = Vector([min(c[k] for c in corners) for k in range(3)])
    high = Vector([max(c[k] for c in corners) for k in range(3)])
    return low, high


def turned(up):
    """A frame of the run: (right, up, towards the viewer)."""
    up = up.normalized()
    side = Vector((1, 0, 0)) if abs(up.x) < 0.9 else Vector((0, 0, 1))
    front = side.cross(up).normalized()
    return up.cross(front), up, front


def look_at(item, eye, target, up):
    item.location = eye
    back = (eye - target).normalized()
    right = up.cross(back).normalized()
    over = back.cross(right)
    matrix = item.matrix_world.to_3x3()
    for row in range(3):
        matrix[row][0], matrix[row][1], matrix[row][2] = right[row], over[row], back[row]
    item.rotation_euler = matrix.to_euler()


def add_camera(options, low, high):
    right, up, front = turned(options.up)
    middle, size = (low + high) / 2, (high - low).length
    data = bpy.data.cameras.new("camera")
    data.angle_y = math.radians(options.angle)
    data.sensor_fit = "VERTICAL"
    data.clip_start, data.clip_end = 0.01 * size, 100 * size
    camera = bpy.data.objects.new("camera", data)
    bpy.context.collection.objects.link(camera)
    target = options.target or middle
    eye = options.eye or middle + size * (1.25 * front + 0.55 * right + 0.8 * up)
    look_at(camera, eye, target, up)
    bpy.context.scene.camera = camera
    return size, middle


def add_light(place, target, up, width, watts, colour):
    data = bpy.data.lights.new("light", "AREA")
    data.energy, data.size, data.color = watts, width, colour
    light = bpy.data.objects.new("light", data)
    bpy.context.collection.objects.link(light)
    look_at(light, place, target, up)


def add_surroundings(options, low, size, middle):
    """A pale floor below everything and the camera, a large light above, a cooler one from the side, and a bright sky to
    reflect."""
    right, up, front = turned(options.up)
    floor = bpy.data.meshes.new("floor")
    lowest = min((low - middle).dot(up), (bpy.context.scene.camera.location - middle).dot(up))
    centre = middle + (lowest - 0.12 * size) * up
    reach = 40 * size
    floor.from_pydata([centre + reach * (x * right + y * front) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], [],
                      [(3, 2, 1, 0)])
    item = bpy.data.objects.new("floor", floor)
    bpy.context.collection.objects.link(item)
    floor.materials.append(matt("floor", (0.30, 0.33, 0.37)))
    watts = 42 * size * size
    add_light(middle + size * (-1.2 * right + 2.2 * up + 0.8 * front), middle, up, 1.2 * size, watts, (1, 0.96, 0.9))
    add_light(middle + size * (2.2 * right + 0.8 * up - 0.4 * front), middle, up, 0.8 * size, 0.35 * watts, (0.8, 0.9, 1))
    world = bpy.context.scene.world or bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.70, 0.82, 1, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.45


def set_up_render(options):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = options.samples
    scene.cycles.use_denoising = False  # Debian's build has no denoiser
    # Total reflection counts as glossy: with fewer bounces, thin water is black where light is reflected inside it.
    scene.cycles.max_bounces = scene.cycles.transmission_bounces = scene.cycles.glossy_bounces = 32
    scene.cycles.transparent_max_bounces = 32
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.cycles.sample_clamp_indirect = 4
    scene.render.resolution_x, scene.render.resolution_y = options.size
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Filmic"
    scene.view_settings.look = "Medium High Contrast"
    scene.view_settings.exposure = 0.6


def main():
    options = arguments()
    frames = frames_in(options)
    if not frames:
        wanted = " of the frames %d to %d" % options.frames if options.frames else ""
        sys.exit("%s: no surface_NNNN.%s%s; `oilskin mesh %s` makes them, --surfaces names another folder of them" %
                 (options.surfaces or options.directory, options.water or "ply", wanted, options.directory))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    set_up_render(options)
    wet = water()
    body_material = matt("body", (0.45, 0.47, 0.50))
    cloth_material = matt("cloth", (0.62, 0.20, 0.11))
    placed = False
    for number, water_file, cloth_files, body_files in frames:
        items = [read_mesh(water_file, "water")]
        items[0].data.materials.append(wet)
        for paths, material in ((cloth_files, cloth_material), (body_files, body_material)):
            for path in paths:
                items.append(read_mesh(path, material.name))
                items[-1].data.materials.append(material)
        if not placed:
            low, high = bounds(items)
            size, middle = add_camera(options, low, high)
            add_surroundings(options, low, size, middle)
            placed = True
        if not bpy.app.background:
            return
        bpy.context.scene.render.filepath = os.path.abspath(
            os.path.join(options.out or options.directory, "render_%04d.png" % number))
        bpy.ops.render.render(write_still=True)
        for item in items:
            mesh = item.data
            bpy.data.objects.remove(item)
            bpy.data.meshes.remove(mesh)


main()
