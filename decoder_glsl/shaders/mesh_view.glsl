// Where a textured mesh is seen from.
layout(std140, TSR_UNIFORMS(0)) uniform TesseraMeshView {
    mat4 tsr_projection; // from places relative to the eye
    vec4 tsr_mesh_eye;   // xyz in the mesh's coordinates
};
