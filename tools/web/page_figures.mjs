// Measures the pages of `tessera view`: their size, the time to the first picture, and the time of a frame relative to
// the same frame drawn from raw texels. Prints the table of tools/README.md.
//   node page_figures.mjs TESSERA CHROMIUM FILE.tess...
// A frame has 640x480 pixels with one ray per pixel. A raw frame samples the decoded texels as one texture with the
// angular images side by side, without tiles and page table. Both kinds take turns; times are medians.
import {execFileSync, spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {basename, join, resolve} from 'node:path';
import {Browser} from '../../tests/web/browser.mjs';

const [tool, program, ...files] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'tessera-figures-'));
const turns = 7;

// Runs in the page.
const measureFrames = `(async turns => {
    const {gl, renderer, surface, kit, info, workers} = tessera, view = {...tessera.view(), rays: 1};
    const Program = renderer.drawing.constructor, [u, v, s, t] = info.size;
    let raw = null;
    if (u * s <= 8192 && v * t <= 8192) {
        const {pixels} = await workers.run({job: 'coarse', level: 0}), texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
        gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA8, u * s, v * t, 1);
        for (const name of ['TEXTURE_MIN_FILTER', 'TEXTURE_MAG_FILTER'])
            gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl[name], gl.LINEAR);
        gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, 0, u * s, v * t, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        // Replaces the functions of the shaders that look up tiles.
        const sample = \`
            vec4 shares(vec2 w) {
                return vec4((1.0 - w.x) * (1.0 - w.y), w.x * (1.0 - w.y), (1.0 - w.x) * w.y, w.x * w.y);
            }
            vec4 rawImage(ivec2 uv, TsrAngularFootprint f) {
                vec2 at = vec2(uv * size.zw + f.low) + 0.5 + f.weight * vec2(notEqual(f.low, f.high));
                return textureLod(coarse, vec3(at / (sides.xy * sides.zw), 0.0), 0.0);
            }
            vec4 fourImages(ivec2 low, ivec2 high, int mip, vec4 share, TsrAngularFootprint a, TsrAngularFootprint b,
                            TsrAngularFootprint c, TsrAngularFootprint d) {
                low <<= mip; high <<= mip;
                return share.x * rawImage(low, a) + share.y * rawImage(ivec2(high.x, low.y), b) +
                       share.z * rawImage(ivec2(low.x, high.y), c) + share.w * rawImage(high, d);
            }\`;
        const camera = \`vec4 cameraColour(ivec2 camera, vec2 at) {
                vec2 place = clamp(at - 0.5, vec2(0.0), vec2(size.xy - 1));
                ivec2 low = ivec2(place), high = min(low + 1, size.xy - 1);
                vec4 share = shares(place - vec2(low));
                #define AT(x, y) texelFetch(coarse, ivec3(ivec2(x, y) * size.zw + camera, 0), 0)
                return share.x * AT(low.x, low.y) + share.y * AT(high.x, low.y) + share.z * AT(low.x, high.y) +
                       share.w * AT(high.x, high.y);
            }\n\`;
        const texts = name => name === 'slots.glsl' ? kit.text(name).replace(/vec4 imageColour[^]*/, sample)
            : kit.text(name).replace(/vec4 cameraColour[^]*?\\nvoid main/, camera + 'void main');
        const program = new Program(gl, {text: texts}, surface.vertex, renderer.sampling);
        raw = {program, coarse: {texture, size: [0, 0, 0, 0], lod: [0, 0], fold: [1, 1]}};
    }
    const pixel = new Uint8Array(4);
    const time = (program, coarse) => {
        const kept = renderer.coarse, begin = performance.now();
        renderer.coarse = coarse;
        gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.target);
        gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, renderer.rays, 0, 0);
        gl.viewport(0, 0, ...view.pixels);
        gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 1]);
        if (surface.hasDepth)
            gl.clearBufferfv(gl.DEPTH, 0, [1]);
        renderer.drawSurface(program, view, [0, 0], 1);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        renderer.coarse = kept;
        return performance.now() - begin;
    };
    const tiles = [], plain = [];
    for (let i = 0; i < turns; ++i) {
        tiles.push(time(renderer.drawing, renderer.coarse));
        if (raw)
            plain.push(time(raw.program, raw.coarse));
    }
    const median = list => list.sort((a, b) => a - b)[list.length >> 1];
    return {tiles: median(tiles), plain: raw ? median(plain) : 0};
})(${turns})`;

function served(file) {
    const server = spawn(tool, ['view', file, '--no-open'], {stdio: ['ignore', 'pipe', 'inherit']});
    return new Promise(done => server.stdout.once('data', text => done({server, url: String(text).trim()})));
}

const kB = bytes => `${(bytes / 1000).toFixed(1)} kB`, ms = time => `${time.toFixed(0)} ms`;
console.log('| file | .tess | page (viewer and decoder) | from disk: first picture, all tiles ' +
            '| from a server: first picture after | frame, relative to raw |');
console.log('|---|---|---|---|---|---|');
const browser = new Browser(program);
try {
    for (const file of files) {
        const page = join(folder, `${basename(file)}.html`), size = '#size=640x480';
        execFileSync(tool, ['view', file, '-o', page, '-q']);
        const text = readFileSync(page, 'latin1');
        const withoutFile = text.replace(/<script type="text\/plain" id="(file|data)">[^<]*/g, '');
        const own = withoutFile.replace(/base64,[^"]*/, '').length;
        await browser.open(`file://${page}${size}`);
        await browser.picture();
        const [first, whole] = await browser.evaluate('[tessera.page.begun, tessera.page.whole]');
        const {tiles, plain} = await browser.evaluate(measureFrames);
        const {server, url} = await served(resolve(file));
        await browser.open(url + size);
        await browser.picture();
        const [begun, received, all] =
            await browser.evaluate('[tessera.page.begun, tessera.page.bytesAtFirst, tessera.source.received]');
        server.kill('SIGTERM');
        const ratio = plain ? `, ${(tiles / plain).toFixed(2)}` : '';
        console.log(`| ${basename(file)} | ${kB(statSync(file).size)} | ${kB(text.length)} (${kB(own)}) ` +
                    `| ${ms(first)}, ${ms(whole)} | ${ms(begun)}, ${kB(received)}; in total ${kB(all)} ` +
                    `| ${ms(tiles)}${ratio} |`);
    }
} finally {
    await browser.close();
    rmSync(folder, {recursive: true, force: true});
}
