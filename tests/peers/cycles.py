"""Renders a scene of assets/scenes in Blender's Cycles, for tests/peers/cycles.

Run by Blender: blender --background --factory-startup --python cycles.py -- SCENE.json METHOD SIZE SPP OUT.exr

METHOD is random_walk or burley. Blender's axes are the model's turned: (x, y, z) becomes (x, -z, y).
"""
import json
import math
import os
import sys
import time

import numpy

numpy.bool = bool  # the glTF importer of Blender 3.4 wants the name that numpy has dropped

import bpy
import mathutils


def turned(v):
    return mathutils.Vector((v[0], -v[2], v[1]))


def clear():
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)


def set_camera(description, scene):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle_y = math.radians(description["vertical_fov"])
    data.clip_start = 1e-4
    camera = bpy.data.objects.new("camera", data)
    forward = turned(description["direction"]).normalized()
    right = forward.cross(turned(description.get("up", [0, 1, 0]))).normalized()
    up = right.cross(forward)
    camera.matrix_world = mathutils.Matrix.Translation(turned(description["position"])) @ mathutils.Matrix(
        (right, up, -forward)).transposed().to_4x4()
    scene.collection.objects.link(camera)
    scene.camera = camera


def set_sky(sky, scene):
    """ambient + key max(0, w . direction)^exponent, invisible to the camera."""
    world = bpy.data.worlds.new("sky")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()

    def math_node(operation, first, second):
        node = nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (first, second)):
            if isinstance(value, (int, float)):
                socket.default_value = value
            else:
                links.new(value, socket)
        return node.outputs[0]

    place = nodes.new("ShaderNodeTexCoord")
    dot = nodes.new("ShaderNodeVectorMath")
    dot.operation = "DOT_PRODUCT"
    links.new(place.outputs["Generated"], dot.inputs[0])
    dot.inputs[1].default_value = turned(sky["direction"]).normalized()
    power = math_node("POWER", math_node("MAXIMUM", dot.outputs["Value"], 0.0), sky["exponent"])
    value = math_node("ADD", math_node("MULTIPLY", power, sky["key"]), sky["ambient"])
    background = nodes.new("ShaderNodeBackground")
    links.new(value, background.inputs["Color"])
    output = nodes.new("ShaderNodeOutputWorld")
    links.new(background.outputs[0], output.inputs["Surface"])
    world.cycles_visibility.camera = False
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 512


def set_material(material, medium, method):
    """Principled BSDF: all of the body light goes below the surface."""
    for node in material.node_tree.nodes:
        if node.type != "BSDF_PRINCIPLED":
            continue
        colour, below = node.inputs["Base Color"], node.inputs["Subsurface Color"]
        for link in material.node_tree.links:
            if link.to_socket == colour:
                material.node_tree.links.new(link.from_socket, below)
        below.default_value = colour.default_value
        node.inputs["Subsurface"].default_value = 1
        path = medium["mean_free_path"]
        # Both methods divide the radius by 4 pi, and the walk then takes it as the mean free path.
        radius = [4 * math.pi * p for p in (path if isinstance(path, list) else [path] * 3)]
        node.inputs["Subsurface Radius"].default_value = radius
        node.inputs["Subsurface IOR"].default_value = medium["eta"]
        node.inputs["Subsurface Anisotropy"].default_value = medium["g"]
        node.inputs["Specular"].default_value = 0.5  # eta 1.5
        node.subsurface_method = "BURLEY" if method == "burley" else "RANDOM_WALK_FIXED_RADIUS"


def main():
    path, method, size, spp, out = sys.argv[sys.argv.index("--") + 1:]
    with open(path, encoding="utf-8") as file:
        description = json.load(file)
    clear()
    scene = bpy.context.scene
    bpy.ops.import_scene.gltf(filepath=os.path.join(os.path.dirname(os.path.abspath(path)), description["model"]))
    for material in bpy.data.materials:
        medium = description["materials"].get(material.name, description["materials"].get("*"))
        if material.use_nodes and medium and medium.get("subsurface", True):
            set_material(material, medium, method)
    set_camera(description["camera"], scene)
    set_sky(description["environment"]["sky"], scene)
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = int(spp)
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False  # Debian's build has no denoiser
    scene.cycles.max_bounces = 64
    scene.cycles.sample_clamp_indirect = 0
    scene.cycles.blur_glossy = 0
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 1
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = int(size)
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = os.path.abspath(out)
    begin, cpu = time.monotonic(), os.times()
    bpy.ops.render.render(write_still=True)
    after = os.times()
    print("CYCLES", time.monotonic() - begin, after.user + after.system - cpu.user - cpu.system)


main()
