// Views of a planar grid of cameras (FORMAT.md 5.3). A ray intersects the plane of the cameras, z = distance, and the
// window z = 0. (s, t) are cameras and (u, v) pixels of their views; t and v increase downwards.
uniform vec3 eye, forward, right, up;
uniform vec2 pixels;     // width and height of the picture
uniform vec2 window;     // width and height of the window, world units
uniform vec2 spacing;    // world units between neighbouring cameras
uniform float distance;  // world units from the window to the cameras
uniform vec2 disparity;  // of the plane in focus, in texels between neighbouring cameras; 0: the window
uniform ivec2 viewSize;  // texels of a view
uniform ivec2 alignment; // shift between neighbouring views in the tile grid, texels (FORMAT.md part 2)
uniform float reach;     // radius of the aperture in camera spacings; 1: interpolates between the nearest cameras
uniform vec4 outside;    // colour of rays that miss the window

vec4 cameraColour(ivec2 camera, vec2 at) {
    vec2 place = clamp(at - 0.5, vec2(0.0), vec2(viewSize - 1));
    ivec2 low = min(ivec2(place), max(viewSize - 2, ivec2(0)));
    ivec2 high = min(low + 1, viewSize - 1);
    vec4 share = shares(place - vec2(low)), colour = vec4(0.0);
    ivec2 shift = abs(alignment) * ivec2(alignment.x < 0 ? size.z - 1 - camera.x : camera.x,
                                         alignment.y < 0 ? size.w - 1 - camera.y : camera.y);
    low += shift;
    high += shift;
    int corner = 0;
#ifndef MARKS // usually one tile contains all four texels
    SlotPlace p = slotPlace(low, 0);
    ivec2 tile = directionTile(camera), next = (high - low) * tileSide.zw;
    uint page = pageOf(tileNumber(p.tile, tile));
    ivec3 pixel = slotPixel(page, p.place) + ivec3(camera - directionBegin(tile), 0);
    colour = share.x * texelFetch(slots, pixel, 0) +
             share.y * texelFetch(slots, pixel + ivec3(next.x, 0, 0), 0) +
             share.z * texelFetch(slots, pixel + ivec3(0, next.y, 0), 0) +
             share.w * texelFetch(slots, pixel + ivec3(next, 0), 0);
    if (page != 0u && slotPlace(high, 0).tile == p.tile)
        corner = 4;
    if (corner == 0)
        colour = vec4(0.0);
#endif
    for (; corner < 4; ++corner)
        colour += share[corner] * imageColour(ivec2((corner & 1) == 0 ? low.x : high.x,
                                                    (corner & 2) == 0 ? low.y : high.y),
                                              0, camera, camera, vec2(0.0));
    return colour;
}

void main() {
    vec2 at = gl_FragCoord.xy / pixels * 2.0 - 1.0;
    vec3 ray = forward + at.x * right + at.y * up;
    vec3 seen = eye - ray * (eye.z / ray.z);
    vec2 place = (seen.xy / window * vec2(1.0, -1.0) + 0.5) * vec2(viewSize);
    if (ray.z >= 0.0 || eye.z <= 0.0 || any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(viewSize)))) {
        finish(outside);
        return;
    }
    vec3 from = eye + ray * ((distance - eye.z) / ray.z);
    vec2 middle = (sides.zw - 1.0) * 0.5;
    vec2 observer = clamp(from.xy / spacing * vec2(1.0, -1.0) + middle, vec2(0.0), sides.zw - 1.0);
    ivec2 first = max(ivec2(floor(observer - reach)) + 1, ivec2(0)); // cameras on the rim have weight 0
    ivec2 last = min(ivec2(ceil(observer + reach)) - 1, size.zw - 1);
    vec4 sum = vec4(0.0);
    float all = 0.0;
    int cameras = 0;
    for (int t = first.y; t <= last.y; ++t)
        for (int s = first.x; s <= last.x; ++s) {
            vec2 off = vec2(s, t) - observer;
            vec2 share = max(1.0 - abs(off) / reach, 0.0);
            float weight = share.x * share.y;
#ifdef MARKS
            if ((cameras++ & 7) != (chosen() & 7))
                continue;
            marked = 0;
#endif
            sum += weight * cameraColour(ivec2(s, t), place + off * disparity);
            all += weight;
        }
    finish(sum / all);
}
