// A pinhole camera outside or inside a textured sphere, as in decoder_glsl/shaders/view.glsl and sample.glsl.
uniform vec4 eye;     // xyz: relative to the centre of the sphere; w: radius of the sphere
uniform vec3 right;   // length: half the picture's width at distance 1
uniform vec3 up;      // length: half the picture's height at distance 1
uniform vec3 forward;
uniform vec2 pixels;  // width and height of the picture
uniform bool inside;
uniform vec4 outside; // colour of rays that miss the sphere

TsrAngularFootprint directions(vec2 longitude, vec2 latitude, vec3 direction) {
    return tsr_footprint_of_angles(tsr_angles(TsrFrame(longitude, latitude), direction), size.zw);
}

// Each of the four surface texels has its own frame and thus its own angles.
vec4 surfaceColour(vec3 fromCentre, vec3 direction) {
    TsrSurfaceFootprint f = tsr_surface_footprint(fromCentre, size.xy);
    TsrFrame low = tsr_frame(f.low, size.xy, inside), high = tsr_frame(f.high, size.xy, inside);
    return fourImages(f.low, f.high, 0, shares(f.weight),
                      directions(low.longitude, low.latitude, direction),
                      directions(high.longitude, low.latitude, direction),
                      directions(low.longitude, high.latitude, direction),
                      directions(high.longitude, high.latitude, direction));
}

void main() {
    vec2 at = gl_FragCoord.xy / pixels * 2.0 - 1.0;
    vec3 ray = normalize(forward + at.x * right + at.y * up);
    // Starts from the point of the ray that is nearest to the centre, because the quadratic formula loses precision at
    // large distances.
    float along = -dot(eye.xyz, ray);
    vec3 nearest = eye.xyz + along * ray;
    float rest = eye.w * eye.w - dot(nearest, nearest);
    if (rest < 0.0 || (along <= 0.0 && !inside)) {
        finish(outside);
        return;
    }
    finish(surfaceColour(nearest + (inside ? sqrt(rest) : -sqrt(rest)) * ray, -ray));
}
