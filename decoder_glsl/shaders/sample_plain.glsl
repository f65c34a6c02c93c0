// A texture that is decoded as a whole: angular images side by side, folded over layers.
ivec3 tsr_plain_pixel(ivec2 texel, ivec2 angle) {
    uint u = tsr_axis(0, texel.x);
    uint v = tsr_axis(1, texel.y);
    return ivec3(int(u & 0xFFFFu) + angle.x, int(v & 0xFFFFu) + angle.y,
                 int((v >> 16) * tsr_parameter(tsr_p_folds_u) + (u >> 16)));
}

vec4 tsr_angular_texel(ivec2 texel, ivec2 angle) {
    return texelFetch(tsr_texels, tsr_plain_pixel(texel, angle), 0);
}

vec4 tsr_angular_image(ivec2 texel, TsrAngularFootprint f) {
    return tsr_mixed(tsr_plain_pixel(texel, f.low), f);
}

vec4 tsr_four_images(TsrSurfaceFootprint f, TsrAngularFootprint low_low,
                     TsrAngularFootprint high_low, TsrAngularFootprint low_high,
                     TsrAngularFootprint high_high) {
    return tsr_mix4(tsr_angular_image(f.low, low_low),
                    tsr_angular_image(ivec2(f.high.x, f.low.y), high_low),
                    tsr_angular_image(ivec2(f.low.x, f.high.y), low_high),
                    tsr_angular_image(f.high, high_high), f.weight);
}
