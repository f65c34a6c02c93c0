// Sampling a plain texture: the whole file is decoded, with angular images side by side and folded
// over layers.
ivec3 tsr_plain_pixel(ivec2 texel) {
    uint u = tsr_axis(0, texel.x);
    uint v = tsr_axis(1, texel.y);
    return ivec3(int(u & 0xFFFFu), int(v & 0xFFFFu),
                 int((v >> 16) * tsr_parameter(tsr_p_folds_u) + (u >> 16)));
}

#ifdef TESSERA_HARDWARE_FILTER
vec4 tsr_plain_mix(ivec2 texel, TsrAngularTaps taps) {
    return tsr_filtered(tsr_plain_pixel(texel) + ivec3(taps.s.x, taps.t.x, 0), tsr_beyond(taps));
}
#endif

vec4 tsr_plain_image(ivec2 texel, TsrAngularTaps taps) {
    return tsr_fetched(tsr_plain_pixel(texel), taps.s, taps.t, taps.shares);
}

vec4 tsr_four_images(TsrSurfaceFootprint f, vec4 shares, TsrAngularTaps low_low,
                     TsrAngularTaps high_low, TsrAngularTaps low_high, TsrAngularTaps high_high) {
    ivec2 high_u = ivec2(f.high.x, f.low.y);
    ivec2 high_v = ivec2(f.low.x, f.high.y);
#ifdef TESSERA_HARDWARE_FILTER
    if (low_low.neighbours) // and so are the others
        return tsr_sum4(tsr_plain_mix(f.low, low_low), tsr_plain_mix(high_u, high_low),
                        tsr_plain_mix(high_v, low_high), tsr_plain_mix(f.high, high_high), shares);
#endif
    return tsr_sum4(tsr_plain_image(f.low, low_low), tsr_plain_image(high_u, high_low),
                    tsr_plain_image(high_v, low_high), tsr_plain_image(f.high, high_high), shares);
}
