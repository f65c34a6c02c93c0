// Writes the colour of a pixel or, with MARKS, the tiles that the pixel needs.
#ifdef MARKS
layout(location = 0) out uvec4 result;
void finish(vec4 colour) {
    result = marks;
}
#else
layout(location = 0) out vec4 result;
void finish(vec4 colour) {
#ifdef LAYERED
    result = colour;
#else
    result = vec4(colour.rgb, 1.0);
#endif
}
#endif
