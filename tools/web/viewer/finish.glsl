// What a pixel shows; with MARKS the tiles that it needs.
#ifdef MARKS
layout(location = 0) out uvec4 result;
void finish(vec4 colour) {
    result = marks;
}
#else
layout(location = 0) out vec4 result;
void finish(vec4 colour) {
    result = vec4(colour.rgb, 1.0);
}
#endif
