// Vertices of a textured mesh, as in decoder_glsl/shaders/mesh.vert.glsl.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 tangent;
layout(location = 3) in vec2 place;

uniform mat4 project; // of positions relative to the eye
uniform vec3 eye;

out vec3 toEye;
out vec3 surfaceNormal;
out vec3 surfaceTangent;
out vec2 surfacePlace;

void main() {
    vec3 fromEye = position - eye;
    toEye = -fromEye;
    surfaceNormal = normal;
    surfaceTangent = tangent;
    surfacePlace = place;
    gl_Position = project * vec4(fromEye, 1.0);
}
