// A texture that is decoded as a whole: angular images side by side, folded over layers.
vec4 tsr_angular_image(ivec2 texel, TsrAngularFootprint f) {
    uint u = tsr_axis(0, texel.x);
    uint v = tsr_axis(1, texel.y);
    ivec3 pixel = ivec3(int(u & 0xFFFFu) + f.low.x, int(v & 0xFFFFu) + f.low.y,
                        int((v >> 16) * tsr_parameter(tsr_p_folds_u) + (u >> 16)));
#ifdef TESSERA_HARDWARE_FILTER
    return tsr_filtered(pixel, f);
#else
    return tsr_fetched(pixel, f);
#endif
}
