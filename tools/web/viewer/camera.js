// A pinhole camera and where it stands: tools/view/camera.cpp once more, so that a page and `tessera render`
// show the same picture. The world is right-handed, y is up.

const add = (a, b) => a.map((x, i) => x + b[i]);
const sub = (a, b) => a.map((x, i) => x - b[i]);
const scale = (a, k) => a.map(x => x * k);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => scale(a, 1 / Math.hypot(...a));
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

// The ray through a point of the picture, x and y from -1 (left, bottom) to 1, runs along
// forward + x * right + y * up. fov: vertical, in degrees.
function makeCamera(pose, fov, aspect) {
    const forward = unit(sub(pose.look, pose.eye));
    const vertical = Math.hypot(forward[0], forward[2]) < 1e-9;
    const upwards = vertical ? [0, 0, forward[1] > 0 ? 1 : -1] : [0, 1, 0];
    const right = unit(cross(forward, upwards));
    const half = Math.tan(fov * Math.PI / 360);
    return {eye: pose.eye, forward, right: scale(right, half * aspect), up: scale(cross(right, forward), half)};
}

// The same picture, moved by a part of a pixel, -1/2..1/2 to the right and down: other rays through its pixels.
function shiftedCamera(camera, [x, y], width, height) {
    return {...camera, forward: add(camera.forward, add(scale(camera.right, 2 * x / width),
                                                        scale(camera.up, -2 * y / height)))};
}

// For OpenGL, of places relative to the eye; columns. The camera may be shifted, so forward counts as it is.
function projection(camera, near, far) {
    const width = Math.hypot(...camera.right), height = Math.hypot(...camera.up);
    const x = scale(camera.right, 1 / width), y = scale(camera.up, 1 / height), z = cross(y, x); // away from the eye
    const shift = [dot(camera.forward, x) / width, dot(camera.forward, y) / height];
    const rows = [
        add(scale(x, 1 / width), scale(z, -shift[0])), add(scale(y, 1 / height), scale(z, -shift[1])),
        scale(z, (far + near) / (far - near)), z];
    const depth = -2 * far * near / (far - near);
    return [0, 1, 2].flatMap(i => rows.map(row => row[i])).concat([0, 0, depth, 0]);
}

// Around the point looked at, by angles in radians; up and down end a little before the axis.
function orbited(pose, yaw, pitch) {
    const arm = sub(pose.eye, pose.look), distance = Math.hypot(...arm);
    const angle = Math.atan2(arm[0], arm[2]) + yaw;
    const height = clamp(Math.asin(clamp(arm[1] / distance, -1, 1)) + pitch, -1.55, 1.55);
    const flat = Math.cos(height) * distance;
    return {look: pose.look, eye: add(pose.look, [Math.sin(angle) * flat, Math.sin(height) * distance, Math.cos(angle) * flat])};
}

// The observer stays and looks elsewhere.
function turned(pose, yaw, pitch) {
    const mirrored = orbited({eye: pose.look, look: pose.eye}, yaw, pitch);
    return {eye: pose.eye, look: mirrored.eye};
}

// Both are moved, by parts of the picture's height at the point looked at.
function panned(pose, fov, x, y) {
    const camera = makeCamera(pose, fov, 1), distance = Math.hypot(...sub(pose.look, pose.eye));
    const step = add(scale(camera.right, -2 * x * distance), scale(camera.up, 2 * y * distance));
    return {eye: add(pose.eye, step), look: add(pose.look, step)};
}
