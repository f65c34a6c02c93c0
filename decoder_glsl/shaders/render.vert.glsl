// One triangle that covers the whole picture, for render.frag.
void main() {
#ifdef TSR_VULKAN
    int corner = gl_VertexIndex;
#else
    int corner = gl_VertexID;
#endif
    gl_Position = vec4(corner == 1 ? 3.0 : -1.0, corner == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
