# Shows a .glb with a Tessera texture in Blender with tools/scripts/blender_gltf.py. The picture of the file must be seen.
#   cmake -DROOT=. -DTESSERA=tessera -DBLENDER=blender -DOUT=folder -P check_blender_gltf.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run_program.cmake)

file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT})
run(${TESSERA} bake composed -o ${OUT}/x.glb --proxy mesh --density 0.25 --directions 2x2 --spp 1 --effort 0
    --meta Background=0,0,0 -q)
run(${BLENDER} -b --factory-startup --python-exit-code 1 -P ${ROOT}/tools/scripts/blender_gltf.py --
    ${OUT}/x.glb ${OUT}/view.png 6,3,2 0,0,0 32x24 cycles)
if(NOT said MATCHES "1 mesh\\(es\\) with the picture of the file; its light field is not shown")
    message(FATAL_ERROR "the script says something else: ${said}")
endif()
execute_process(COMMAND ${TESSERA} render ${OUT}/x.glb -o ${OUT}/ours.png --eye 6,3,2 --pixels 32x24 -q)
execute_process(COMMAND ${TESSERA} compare ${OUT}/ours.png ${OUT}/view.png --json OUTPUT_VARIABLE said)
string(JSON psnr GET "${said}" psnr)
if(psnr LESS 20) # not equal, because the directions differ
    message(FATAL_ERROR "Blender shows something else: ${psnr} dB")
endif()
