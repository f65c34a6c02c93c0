"""Writes a mesh with a share of its triangles, without normals, by Blender's Decimate modifier (collapsed edges):
    blender -b -P decimate.py -- MESH.obj OUT.obj SHARE"""
import bpy, sys

source, out, share = sys.argv[-3:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=source, forward_axis='Y', up_axis='Z')
for thing in bpy.context.scene.objects:
    thing.modifiers.new('fewer', 'DECIMATE').ratio = float(share)
bpy.ops.wm.obj_export(filepath=out, forward_axis='Y', up_axis='Z', export_normals=False, export_uv=False,
                      export_materials=False)
