// Vertices of a textured mesh.
#include "dialect.glsl"

layout(std140, TSR_UNIFORMS(0)) uniform TesseraMeshView {
    mat4 tsr_projection; // of positions relative to the eye
    vec4 tsr_mesh_eye;   // xyz in the mesh's coordinates
};

layout(location = 0) in vec3 tsr_position;
layout(location = 1) in vec3 tsr_normal;
layout(location = 2) in vec3 tsr_tangent;
layout(location = 3) in vec2 tsr_uv;

// At the middle of the pixel, also where the triangle does not cover it: gutters of the atlas continue
// the charts. Between centroids uv would have wrong derivatives, and llvmpipe's are off by pixels.
layout(location = 0) out vec3 tsr_to_eye;
layout(location = 1) out vec3 tsr_surface_normal;
layout(location = 2) out vec3 tsr_surface_tangent;
layout(location = 3) out vec2 tsr_place;

// The passes for depths and for colours must compute the same depths.
invariant gl_Position;

void main() {
    vec3 from_eye = tsr_position - tsr_mesh_eye.xyz;
    tsr_to_eye = -from_eye;
    tsr_surface_normal = tsr_normal;
    tsr_surface_tangent = tsr_tangent;
    tsr_place = tsr_uv;
    gl_Position = tsr_projection * vec4(from_eye, 1.0);
}
