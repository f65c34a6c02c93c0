// A pinhole camera and its poses. It follows tools/view/camera.cpp, so that a page and `tessera render` show the same
// picture. The world is right-handed and y points up.

const add = (a, b) => a.map((x, i) => x + b[i]);
const sub = (a, b) => a.map((x, i) => x - b[i]);
const scale = (a, k) => a.map(x => x * k);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => scale(a, 1 / Math.hypot(...a));
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

// The ray through point (x, y) of the picture, with x and y from -1 (left, bottom) to 1, has the direction
// forward + x * right + y * up. fov is the vertical field of view in degrees.
function makeCamera(pose, fov, aspect) {
    const forward = unit(sub(pose.look, pose.eye));
    const vertical = Math.hypot(forward[0], forward[2]) < 1e-9;
    const upwards = vertical ? [0, 0, forward[1] > 0 ? 1 : -1] : [0, 1, 0];
    const right = unit(cross(forward, upwards));
    const half = Math.tan(fov * Math.PI / 360);
    return {eye: pose.eye, forward, right: scale(right, half * aspect), up: scale(cross(right, forward), half)};
}

// The camera whose rays are shifted by (x, y) pixels to the right and down, each -1/2..1/2.
function shiftedCamera(camera, [x, y], width, height) {
    return {...camera, forward: add(camera.forward, add(scale(camera.right, 2 * x / width),
                                                        scale(camera.up, -2 * y / height)))};
}

// The projection matrix of OpenGL, in columns, for positions relative to the eye. `forward` is not normalised, because
// the camera may be shifted.
function projection(camera, near, far) {
    const width = Math.hypot(...camera.right), height = Math.hypot(...camera.up);
    const x = scale(camera.right, 1 / width), y = scale(camera.up, 1 / height);
    const z = cross(y, x); // points away from the eye
    const shift = [dot(camera.forward, x) / width, dot(camera.forward, y) / height];
    const rows = [
        add(scale(x, 1 / width), scale(z, -shift[0])), add(scale(y, 1 / height), scale(z, -shift[1])),
        scale(z, (far + near) / (far - near)), z];
    const depth = -2 * far * near / (far - near);
    return [0, 1, 2].flatMap(i => rows.map(row => row[i])).concat([0, 0, depth, 0]);
}

// Moves the eye around the look-at point by angles in radians. The pitch stops just before the vertical axis.
function orbited(pose, yaw, pitch) {
    const arm = sub(pose.eye, pose.look), distance = Math.hypot(...arm);
    const angle = Math.atan2(arm[0], arm[2]) + yaw;
    const height = clamp(Math.asin(clamp(arm[1] / distance, -1, 1)) + pitch, -1.55, 1.55);
    const flat = Math.cos(height) * distance;
    const direction = [Math.sin(angle) * flat, Math.sin(height) * distance, Math.cos(angle) * flat];
    return {look: pose.look, eye: add(pose.look, direction)};
}

// Turns the camera around its eye by angles in radians.
function turned(pose, yaw, pitch) {
    const mirrored = orbited({eye: pose.look, look: pose.eye}, yaw, pitch);
    return {eye: pose.eye, look: mirrored.eye};
}

// Moves eye and look-at point by (x, y) in picture heights at the distance of the look-at point.
function panned(pose, fov, x, y) {
    const camera = makeCamera(pose, fov, 1), distance = Math.hypot(...sub(pose.look, pose.eye));
    const step = add(scale(camera.right, -2 * x * distance), scale(camera.up, 2 * y * distance));
    return {eye: add(pose.eye, step), look: add(pose.look, step)};
}
