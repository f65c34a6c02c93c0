// The GLSL example that README.md links to. Prepend sample.glsl of `tessera shaders`.
in vec3 place;    // point of the surface, relative to the sphere's centre
uniform vec3 eye; // position of the observer, relative to the same centre
out vec4 colour;
void main() {
    colour = tessera_sample(place, normalize(eye - place));
}
