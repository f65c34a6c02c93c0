// The kinds of surfaces that carry textures. Each class computes its uniforms for a view and draws itself.

class SphereSurface {
    constructor(info, outside) {
        Object.assign(this, {info, outside, fragment: ['sphere.frag'], vertex: ['screen.vert'], rays: 1});
        this.inside = info.inside;
    }
    defaultPose() {
        return this.inside ? {eye: this.info.centre, look: add(this.info.centre, [-1, 0, 0])}
                           : {eye: [10, 0, 0], look: [0, 0, 0]};
    }
    // The observer must stay on the side from which the texture is seen.
    allowed(pose) {
        const arm = sub(pose.eye, this.info.centre), distance = Math.hypot(...arm), {radius} = this.info;
        return this.inside ? distance < radius * 0.999 : distance > radius * 1.001;
    }
    uniforms(view, camera) {
        return {...camera, eye: [...sub(camera.eye, this.info.centre), this.info.radius], inside: this.inside,
                outside: this.outside, pixels: view.pixels};
    }
    draw(gl) {
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
}

class MeshSurface {
    constructor(gl, info, mesh, outside) {
        // 4 rays per pixel for a still picture, as in `tessera render`.
        Object.assign(this,
                      {info, mesh, outside, fragment: ['atlas.glsl', 'mesh.frag'], vertex: ['mesh.vert'], rays: 4, hasDepth: true});
        this.array = gl.createVertexArray();
        gl.bindVertexArray(this.array);
        [[mesh.positions, 3], [mesh.normals, 3], [mesh.tangents, 3], [mesh.uv, 2]].forEach(([data, components], i) => {
            gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
            gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
            gl.vertexAttribPointer(i, components, gl.FLOAT, false, 0, 0);
            gl.enableVertexAttribArray(i);
        });
        this.indices = gl.createBuffer();
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
        gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.indices, gl.STATIC_DRAW);
        gl.bindVertexArray(null);
        this.charts = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.charts);
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        const withMips = mesh.atlases.filter(charts => charts.mips);
        const [width, height] = ['width', 'height'].map(side => Math.max(1, ...withMips.map(charts => charts[side])));
        gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.R16UI, width, height, mesh.atlases.length);
        mesh.atlases.forEach(({mips, width, height, ids}, i) => mips && gl.texSubImage3D(
            gl.TEXTURE_2D_ARRAY, 0, 0, 0, i, width, height, 1, gl.RED_INTEGER, gl.UNSIGNED_SHORT, ids));
        nearest(gl, gl.TEXTURE_2D_ARRAY);
        this.bounds = {low: mesh.low, high: mesh.high};
        this.centre = scale(add(mesh.low, mesh.high), 0.5);
        this.radius = Math.hypot(...sub(mesh.high, mesh.low)) / 2;
    }
    // Meshes of models and photographs may be anywhere and of any size. Those that fill the sphere of the paper's scene
    // are seen as that scene.
    defaultPose() {
        const {low, high} = this.bounds, far = Math.max(...low.map(Math.abs), ...high.map(Math.abs));
        const {centre, mesh: {positions}} = this;
        let radius = 0;
        for (let i = 0; i < positions.length; i += 3)
            radius = Math.max(radius, Math.hypot(...[0, 1, 2].map(axis => positions[i + axis] - centre[axis])));
        return far <= 3.6 && radius >= 2 && Math.hypot(...centre) <= 1 
            ? {eye: [10, 0, 0], look: [0, 0, 0]}
            : {eye: add(centre, [10 / 3.5 * radius, 0, 0]), look: centre};
    }
    allowed() {
        return true;
    }
    uniforms(view, camera, rays) {
        const distance = Math.hypot(...sub(camera.eye, this.centre));
        const far = (distance + this.radius) * 1.01, near = Math.max((distance - this.radius) * 0.99, far / 10000);
        return {project: projection(camera, near, far), eye: camera.eye,
                atlases: this.mesh.atlases.flatMap(({size, mips}) => [...size, mips, 0]),
                charts: {texture: this.charts, target: WebGL2RenderingContext.TEXTURE_2D_ARRAY},
                angularMap: this.info.angularMap, rayWidth: 1 / Math.sqrt(rays)};
    }
    // Draws over what draw() has drawn, from back to front by the distances of the triangles' middles.
    drawBlended(gl, eye) {
        const {positions, indices} = this.mesh, count = indices.length / 3;
        if (!this.sorted) {
            this.sorted = {array: new Uint32Array(indices.length), buffer: gl.createBuffer(), eye: null};
            this.middles = new Float32Array(indices.length);
            for (let i = 0; i < indices.length; ++i)
                for (let axis = 0; axis < 3; ++axis)
                    this.middles[i - i % 3 + axis] += positions[3 * indices[i] + axis] / 3;
        }
        const {array, buffer} = this.sorted, {middles} = this;
        gl.bindVertexArray(this.array);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
        if (this.sorted.eye?.join() !== eye.join()) {
            // Numbers that hold the distance in their upper bits and the triangle below are sorted fastest.
            const keys = new Float64Array(count), [x, y, z] = eye;
            const farthest = Math.hypot(...sub(eye, this.centre)) + this.radius;
            for (let i = 0; i < count; ++i) {
                const distance = Math.hypot(middles[3 * i] - x, middles[3 * i + 1] - y, middles[3 * i + 2] - z);
                keys[i] = Math.floor((1 - distance / farthest) * 2 ** 28) * 2 ** 24 + i;
            }
            keys.sort().forEach((key, to) => {
                const from = 3 * (key % 2 ** 24);
                array.set(indices.subarray(from, from + 3), 3 * to);
            });
            gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, array, gl.DYNAMIC_DRAW);
            this.sorted.eye = [...eye];
        }
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        gl.depthMask(false);
        this.drawElements(gl);
        gl.depthMask(true);
        gl.disable(gl.BLEND);
        gl.bindVertexArray(this.array);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
        gl.bindVertexArray(null);
    }
    draw(gl) {
        gl.bindVertexArray(this.array);
        this.drawElements(gl);
        gl.bindVertexArray(null);
    }
    drawElements(gl) {
        gl.enable(gl.DEPTH_TEST);
        gl.enable(gl.CULL_FACE);
        gl.drawElements(gl.TRIANGLES, this.mesh.indices.length, gl.UNSIGNED_INT, 0);
        gl.disable(gl.CULL_FACE);
        gl.disable(gl.DEPTH_TEST);
    }
}

// The observer stands in the plane of the cameras and looks through a fixed window, without turning.
class PlanarSurface {
    // cameras: the four numbers of the metadata key Cameras: spacing along x and y, distance from the window, width of
    // the window; null if the file has no such key.
    constructor(info, outside, cameras) {
        Object.assign(this, {info, outside, fragment: ['planar.frag'], vertex: ['screen.vert'], rays: 1, planar: true});
        const [u, v, s, t] = info.size;
        // Defaults: the window is 2 wide and fills 40 degrees, and the grid is a quarter of its distance wide.
        const usual = 1 / Math.tan(Math.PI / 9), step = usual / 4 / Math.max(1, s - 1, t - 1);
        const [x, y, distance, width] = cameras || [step, step, usual, 2];
        Object.assign(this, {spacing: [x, y], distance, width, height: width * v / u});
        this.reachOfGrid = [(s - 1) / 2 * x, (t - 1) / 2 * y];
    }
    // The observer is in the middle of the cameras and sees the whole window.
    defaultPose() {
        return {eye: [0, 0, this.distance], middle: [0, 0], zoom: 1, disparity: 0, reach: 1};
    }
    allowed(pose) {
        return pose.eye[2] > 0;
    }
    // The disparity of objects at distance `focus` from the cameras, in texels from one camera to the next.
    disparityAt(focus) {
        return this.spacing[0] * (1 - this.distance / focus) * this.info.size[0] / this.width;
    }
    // A pose from the hash may say where the observer looks, as for other surfaces. Otherwise the camera looks through
    // the window.
    camera({eye, look, middle, zoom}, fov, aspect) {
        if (look)
            return makeCamera({eye, look}, fov, aspect);
        const half = Math.max(this.height, this.width / aspect) / 2 / zoom;
        return {eye, forward: sub([...middle, 0], eye), right: [half * aspect, 0, 0], up: [0, half, 0]};
    }
    uniforms(view, camera) {
        const {disparity, reach} = view.pose, {width, height, spacing, distance, outside} = this;
        return {...camera, pixels: view.pixels, window: [width, height], spacing, distance, reach, outside,
                viewSize: this.info.size.slice(0, 2), alignment: this.info.alignment,
                disparity: [disparity, disparity * spacing[1] / spacing[0]]};
    }
    draw(gl) {
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
}
