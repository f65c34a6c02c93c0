// Views of a planar grid of cameras: the observer moves in the plane of the cameras, and things at one distance
// are in focus. FORMAT.md 5.3: (s, t) are cameras, (u, v) pixels, v downwards.
uniform vec4 window;     // texels of the picture's left, top, right, bottom
uniform vec2 pixels;     // width and height of the picture
uniform vec2 observer;   // between the cameras, 0..S-1 and 0..T-1
uniform float disparity; // texels by which what is in focus moves from one camera to the next
uniform float reach;     // of the aperture, in cameras; 1: between the nearest ones alone

uniform vec4 outside;

vec4 cameraColour(ivec2 camera, vec2 at) {
    vec2 place = clamp(at - 0.5, vec2(0.0), vec2(size.xy - 1));
    ivec2 low = min(ivec2(place), max(size.xy - 2, ivec2(0)));
    ivec2 high = min(low + 1, size.xy - 1);
    vec2 w = place - vec2(low);
    return mix(mix(imageColour(low, 0, camera, camera, vec2(0.0)),
                   imageColour(ivec2(high.x, low.y), 0, camera, camera, vec2(0.0)), w.x),
               mix(imageColour(ivec2(low.x, high.y), 0, camera, camera, vec2(0.0)),
                   imageColour(high, 0, camera, camera, vec2(0.0)), w.x), w.y);
}

void main() {
    vec2 at = vec2(gl_FragCoord.x, pixels.y - gl_FragCoord.y) / pixels;
    vec2 place = mix(window.xy, window.zw, at);
    if (any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(size.xy)))) {
        finish(outside);
        return;
    }
    ivec2 first = max(ivec2(ceil(observer - reach)), ivec2(0));
    ivec2 last = min(ivec2(floor(observer + reach)), size.zw - 1);
    vec4 sum = vec4(0.0);
    float all = 0.0;
    int cameras = 0;
    for (int t = first.y; t <= last.y; ++t)
        for (int s = first.x; s <= last.x; ++s) {
            vec2 off = vec2(s, t) - observer;
            vec2 share = max(1.0 - abs(off) / reach, 0.0);
            float weight = share.x * share.y;
            if (weight > 0.0) {
#ifdef MARKS
                if ((cameras++ & 7) != (chosen() & 7))
                    continue;
                marked = 0;
#endif
                sum += weight * cameraColour(ivec2(s, t), place + off * disparity);
                all += weight;
            }
        }
    finish(sum / all);
}
