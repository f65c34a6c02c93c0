// Draws the surface with one or more rays per pixel, and finds the tiles that a view needs.

// The offset of ray k of n from the centre of its pixel, as in tools/view/view_drawing.h, from the middle outwards.
const rayShift = (k, n) => [0.618033988749895, 0.732050807568877].map(
    step => ((k % 2 ? -k - n % 2 : k + 1 - n % 2) / 2 * step + n + 0.5) % 1 - 0.5);

const linearOf = x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;

class Renderer {
    static mostRays = 16;

    // layers: LayerPictures, or null for a file of one texture.
    constructor(gl, kit, info, surface, cache, layers) {
        Object.assign(this, {gl, kit, info, surface, cache, layers, coarse: null});
        this.half = info.sampleType === SAMPLE_TYPE.half16;
        // Means of half floats need more than 8 bits. Without the extension they are clamped to 0..1.
        this.format = this.half && gl.getExtension('EXT_color_buffer_float') ? gl.RGBA16F : gl.RGBA8;
        // Surfaces are blended in linear light.
        this.blends = !!layers?.has(LAYER_ROLE.opacity);
        if (this.blends)
            this.format = gl.SRGB8_ALPHA8;
        this.sampling = ['surface.glsl', 'octahedral.glsl', 'slots.glsl', 'finish.glsl', ...surface.fragment];
        this.drawing = layers
            ? new Program(gl, kit, surface.vertex,
                          [...this.sampling.slice(0, -1), 'layers.glsl', 'layered.glsl', ...this.sampling.slice(-1)],
                          ['LAYERED'])
            : new Program(gl, kit, surface.vertex, this.sampling);
        this.marking = null; // compiled by the first tilesOf()
        this.resolving = new Program(gl, kit, ['screen.vert'], ['resolve.frag']);
        this.sizes = {};
    }

    // Draws ray k of each pixel and shows the mean of rays 0..k. view: {pixels: [width, height], pose, camera, rays},
    // where `rays` is the number of rays of the finished picture.
    addRay(view, k) {
        const {gl} = this;
        this.resize(view.pixels, view.rays);
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
        gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, this.rays, 0, k);
        gl.viewport(0, 0, ...view.pixels);
        gl.clearBufferfv(gl.COLOR, 0, this.blends ? this.surface.outside.map(linearOf) : this.surface.outside);
        if (this.surface.hasDepth)
            gl.clearBufferfv(gl.DEPTH, 0, [1]);
        this.drawSurface(this.drawing, view, rayShift(k, view.rays), view.rays);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        this.resolving.use(
            {rays: {texture: this.rays, target: gl.TEXTURE_2D_ARRAY}, count: k + 1,
             toneMapped: this.half && !this.layers, linear: this.blends});
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    drawSurface(program, view, shift, rays) {
        const {gl, surface, cache, coarse} = this;
        const camera = shiftedCamera(view.camera, shift, ...view.pixels);
        program.use({
            ...cache.grid.uniforms,
            slots: {texture: cache.texture, target: gl.TEXTURE_2D_ARRAY},
            pages: {texture: cache.pages, target: gl.TEXTURE_2D},
            slotSize: [cache.layout.width, cache.layout.height], layerSize: cache.layerSize,
            mipRow: [0, 1, 2, 3, 4].map(mip => cache.layout.rows[mip] || 0),
            coarse: {texture: coarse ? coarse.texture : cache.texture, target: gl.TEXTURE_2D_ARRAY},
            coarseSize: coarse ? coarse.size : [0, 0, 0, 0], coarseLod: coarse ? coarse.lod : [0, 0],
            coarseFold: coarse ? coarse.fold : [1, 1], emptyColour: this.empty,
            ...this.layers?.uniforms, ...surface.uniforms(view, camera, rays), blends: this.blends, drawsBlended: false});
        surface.draw(gl);
        if (this.blends && program === this.drawing) {
            gl.uniform1i(program.uniforms.get('drawsBlended').at, 1);
            surface.drawBlended(gl, view.camera.eye);
        }
    }

    resize([width, height], rays) {
        const {gl, sizes} = this;
        if (sizes.width === width && sizes.height === height && sizes.rays >= rays)
            return;
        Object.assign(sizes, {width, height, rays});
        gl.deleteTexture(this.rays);
        gl.deleteRenderbuffer(this.depth);
        gl.deleteFramebuffer(this.target);
        this.rays = arrayTexture(gl, this.format, width, height, rays, gl.NEAREST);
        this.target = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
        this.depth = this.surface.hasDepth ? this.depthBuffer(width, height) : null;
    }

    depthBuffer(width, height) {
        const {gl} = this, buffer = gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, buffer);
        return buffer;
    }

    // The tiles that a view needs: a map from the tile to the number of pixels that use it. The picture is `reduction`
    // times smaller along both sides. corner: the one of four texels that is examined at each pixel, 0..3, plus 4 for
    // the second of two mips; -1: it varies from pixel to pixel, for an approximate result.
    tilesOf(view, reduction, corner, shift) {
        const {gl} = this;
        this.marking ||= new Program(gl, this.kit, this.surface.vertex, this.sampling, ['MARKS']);
        const pixels = view.pixels.map(n => Math.max(1, Math.ceil(n / reduction)));
        const texture = gl.createTexture(), target = gl.createFramebuffer();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32UI, ...pixels);
        gl.bindFramebuffer(gl.FRAMEBUFFER, target);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
        const depth = this.surface.hasDepth ? this.depthBuffer(...pixels) : null;
        gl.viewport(0, 0, ...pixels);
        gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
        if (depth)
            gl.clearBufferfv(gl.DEPTH, 0, [1]);
        gl.useProgram(this.marking.program);
        gl.uniform1i(this.marking.uniforms.get('corner').at, corner);
        const rays = view.rays * reduction ** 2; // selects the same mips as the view
        this.drawSurface(this.marking, {...view, pixels}, shift, rays);
        const words = new Uint32Array(pixels[0] * pixels[1] * 4), counts = new Map();
        gl.readPixels(0, 0, ...pixels, gl.RGBA_INTEGER, gl.UNSIGNED_INT, words);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.deleteFramebuffer(target);
        gl.deleteTexture(texture);
        gl.deleteRenderbuffer(depth);
        for (const word of words)
            if (word)
                counts.set(word - 1, (counts.get(word - 1) || 0) + 1);
        return counts;
    }

    get bytes() {
        const {width = 0, height = 0, rays = 0} = this.sizes;
        return this.cache.bytes + (this.coarse ? this.coarse.bytes : 0) + (this.layers ? this.layers.bytes : 0) +
               width * height * rays * (this.format === this.gl.RGBA16F ? 8 : 4);
    }
}
