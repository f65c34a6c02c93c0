// Converts mouse, touch and key events to changes of the pose. Distances are in picture heights.

class Controls {
    static turn = 2.4; // radians per picture height of a drag

    constructor(canvas, viewer) {
        Object.assign(this, {canvas, viewer, pointers: new Map()});
        canvas.addEventListener('pointerdown', event => this.down(event));
        canvas.addEventListener('pointermove', event => this.move(event));
        for (const name of ['pointerup', 'pointercancel'])
            canvas.addEventListener(name, event => this.pointers.delete(event.pointerId));
        canvas.addEventListener('wheel', event => this.wheel(event), {passive: false});
        canvas.addEventListener('contextmenu', event => event.preventDefault());
        canvas.addEventListener('dblclick', () => viewer.reset());
        addEventListener('keydown', event => this.key(event));
    }

    down(event) {
        this.canvas.setPointerCapture(event.pointerId);
        this.canvas.focus();
        this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    }

    move(event) {
        const last = this.pointers.get(event.pointerId);
        if (!last)
            return;
        const now = [event.clientX, event.clientY], before = [...this.pointers.values()];
        this.pointers.set(event.pointerId, now);
        const height = this.canvas.clientHeight, [x, y] = scale(sub(now, last), 1 / height);
        if (before.length === 2) { // two fingers: moving them pans, and their distance zooms
            const [a, b] = this.pointers.values(), [p, q] = before;
            this.zoom(Math.hypot(...sub(p, q)) / Math.max(1, Math.hypot(...sub(a, b))));
            this.pan(x / 2, y / 2);
        } else if (before.length === 1) {
            const second = event.buttons & 6 || event.shiftKey; // another button than the first, or shift
            if (second)
                this.pan(x, y);
            else
                this.drag(x, y);
        }
    }

    // The wheel zooms. For planar views it changes the focus, with shift the aperture; it zooms with ctrl, which
    // browsers also report for pinching.
    wheel(event) {
        event.preventDefault();
        const lines = (event.deltaY || event.deltaX) * (event.deltaMode === 1 ? 16 : 1);
        if (!this.viewer.surface.planar || event.ctrlKey)
            this.zoom(Math.exp(lines * 0.001));
        else if (event.shiftKey)
            this.aperture(Math.exp(-lines * 0.002));
        else
            this.focus(lines * 0.001);
    }

    key(event) {
        if (event.ctrlKey || event.metaKey || event.altKey)
            return;
        const step = 0.05, [x, y] = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step],
                                     ArrowDown: [0, step]}[event.key] || [0, 0];
        const actions = {
            '+': () => this.zoom(0.9), '=': () => this.zoom(0.9), '-': () => this.zoom(1 / 0.9),
            '[': () => this.focus(-0.05), ']': () => this.focus(0.05),
            ',': () => this.aperture(1 / 1.2), '.': () => this.aperture(1.2),
            r: () => this.viewer.reset(), Home: () => this.viewer.reset(), v: () => this.viewer.frameAll(),
            f: () => this.viewer.fullScreen(), i: () => this.viewer.toggleFigures(), h: () => this.viewer.toggleHelp()};
        if (x || y)
            event.shiftKey ? this.pan(x, y) : this.drag(-x, -y);
        else if (actions[event.key])
            actions[event.key]();
        else
            return;
        event.preventDefault();
    }

    drag(x, y) {
        const {viewer} = this, {pose, surface} = viewer, turn = Controls.turn;
        if (surface.planar)
            viewer.pose = {...pose, eye: this.stepped(pose.eye, [-x, y])};
        else if (surface.inside) // the picture follows the pointer
            viewer.pose = turned(pose, x * turn / 2, y * turn / 2);
        else
            viewer.pose = orbited(pose, -x * turn, y * turn);
    }

    // Moves the observer of planar views, at most as far as the grid of cameras extends.
    stepped(eye, by) {
        const {reachOfGrid} = this.viewer.surface, all = 3 * Math.max(...reachOfGrid);
        return eye.map((at, i) => i < 2 ? clamp(at + by[i] * all, -reachOfGrid[i], reachOfGrid[i]) : at);
    }

    pan(x, y) {
        const {viewer} = this, {pose, surface} = viewer;
        if (surface.planar) {
            const height = 2 * viewer.view().camera.up[1], half = [surface.width / 2, surface.height / 2];
            const moved = add(pose.middle, [-x * height, y * height]);
            viewer.pose = {...pose, middle: moved.map((at, i) => clamp(at, -half[i], half[i]))};
        } else
            viewer.pose = panned(pose, viewer.fov, x, y);
    }

    // Multiplies the distance by `factor`; below 1 moves nearer.
    zoom(factor) {
        const {viewer} = this, {pose, surface} = viewer;
        if (surface.planar)
            viewer.pose = {...pose, zoom: clamp(pose.zoom / factor, 0.25, 64)};
        else if (surface.inside)
            viewer.fov = clamp(viewer.fov * factor, 5, 120);
        else
            viewer.pose = {...pose, eye: add(pose.look, scale(sub(pose.eye, pose.look), factor))};
    }

    focus(by) {
        const {viewer} = this;
        if (viewer.surface.planar)
            viewer.pose = {...viewer.pose, disparity: clamp(viewer.pose.disparity + by, -64, 64)};
    }

    aperture(factor) {
        const {viewer} = this, [, , s, t] = viewer.info.size, most = clamp(Math.max(s, t) / 2, 1, 12);
        if (viewer.surface.planar)
            viewer.pose = {...viewer.pose, reach: clamp(viewer.pose.reach * factor, 1, most)};
    }
}
