// The GLSL example that README.md links to. sample.glsl of `tessera shaders` comes before it.
in vec3 place;    // on the surface, from the sphere's centre
uniform vec3 eye; // of the observer, from the same centre
out vec4 colour;
void main() {
    colour = tessera_sample(place, normalize(eye - place));
}
