# In Blender: imports FILM.glb and compares places with FILM.pc2 (`clothlab record` makes both of one recording): five
# vertices of the first cloth at five times. Prints the farthest distance [m]; exits 1 beyond a tenth of a millimetre:
# Blender rounds times to hundredths of its frames, of which a second has 1000, and cloth moves at up to 10 m/s.
import struct
import sys

import bpy

film = sys.argv[sys.argv.index("--") + 1]
bpy.ops.wm.read_factory_settings(use_empty=True)
rate = float(sys.argv[sys.argv.index("--") + 2])
bpy.context.scene.render.fps = 1000
bpy.ops.import_scene.gltf(filepath=film + ".glb", merge_vertices=False)
with open(film + ".pc2", "rb") as file:
    points, _, _, samples = struct.unpack("<iffi", file.read(32)[16:])
    places = struct.unpack(f"<{3 * points * samples}f", file.read())
meshes = [each for each in bpy.data.objects if each.type == "MESH"]
cloth = bpy.data.objects[sys.argv[sys.argv.index("--") + 3]]  # the first one of the scene
count = len(cloth.data.vertices)
farthest = 0.0
for k in range(5):
    sample = k * (samples - 1) // 4
    at = sample / rate * bpy.context.scene.render.fps
    bpy.context.scene.frame_set(int(at), subframe=at - int(at))
    shown = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get())
    for n in range(5):
        vertex = n * (count - 1) // 4
        x, y, z = shown.matrix_world @ shown.data.vertices[vertex].co
        wanted = places[3 * (points * sample + vertex) :][:3]
        distance = sum((a - b) ** 2 for a, b in zip((x, z, -y), wanted)) ** 0.5  # Blender's z is up
        farthest = max(farthest, distance)
print(f"{bpy.app.version_string}: {[each.name for each in meshes]}, {count} vertices, {samples} frames, farthest {farthest}")
sys.exit(farthest > 1e-4)
