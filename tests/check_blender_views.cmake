# Renders Blender's default cube with tools/scripts/blender_views.py, as planar views, as a sphere and
# as photographs. Encodes the first two, and reads the third with their cameras.
#   cmake -DROOT=. -DTESSERA=tessera -DBLENDER=blender -DOUT=folder -P check_blender_views.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run_program.cmake)

function(render)
    run(${BLENDER} -b --factory-startup --python-exit-code 1
        --python-expr "__import__('bpy').context.scene.cycles.samples = 1"
        -P ${ROOT}/tools/scripts/blender_views.py -- ${ARGN})
endfunction()

function(expect size)
    run(${TESSERA} encode ${ARGN} -o ${OUT}/x.tess --effort 0)
    if(NOT said MATCHES "${size}, 3 x")
        message(FATAL_ERROR "not ${size}: ${said}")
    endif()
endfunction()

file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT})
render(planar ${OUT}/views 3x2 0.4 11 16x12)
expect(16x12x3x2 ${OUT}/views)
render(sphere ${OUT}/s.exr 4x2x3x3 2)
expect(4x2x3x3 ${OUT}/s.exr --mosaic 3x3)
render(photos ${OUT}/photos 3 2 16x12 8 30)
run(${TESSERA} compare ${OUT}/photos/transforms_test.json ${OUT}/photos/test)
if(NOT said MATCHES "r_1 +exact" OR said MATCHES "warning" OR NOT EXISTS ${OUT}/photos/mesh.obj)
    message(FATAL_ERROR "not two photographs and a mesh: ${said}")
endif()
# The cameras are around the origin, at least 30 degrees above the horizon.
file(READ ${OUT}/photos/transforms_train.json cameras)
foreach(frame RANGE 2)
    string(JSON height GET ${cameras} frames ${frame} transform_matrix 2 3)
    if(height LESS 4)
        message(FATAL_ERROR "a camera is too low: ${height}")
    endif()
endforeach()
