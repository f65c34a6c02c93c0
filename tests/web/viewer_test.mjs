// Tests the viewer in a real browser: it must draw what `tessera render` draws, and cope with user
// input and bad networks.
//   node viewer_test.mjs TESSERA [CHROMIUM [PART OF A TEST'S NAME]]
// Exit codes: 0 all tests pass, 1 a test fails, 77 Chromium or the tool's browser decoder is
// missing.
import assert from 'node:assert/strict';
import {execFileSync, spawn, spawnSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {Browser} from './browser.mjs';
import {bumpyBox, fitBox} from './models.mjs';
import {compared, readPng} from './png.mjs';
import {movingColour, texelsOf} from './textures.mjs';

const [tool, program = 'chromium', only = ''] = process.argv.slice(2);
const renderer = process.env.TESSERA_RENDERER || tool; // another build may draw the reference
const near = 0.999;          // share of pixels that must be within one step of 255
const pageBudget = 220_000;  // bytes of viewer and decoder in a page
const folder = mkdtempSync(join(tmpdir(), 'tessera-viewer-'));
const inFolder = name => join(folder, name);
const tessera = (...args) => execFileSync(tool, args, {stdio: ['ignore', 'pipe', 'pipe']});

// Views of 5x5 cameras: a pattern far away, and a nearer square that moves by two texels from
// camera to camera.
function planarColour(u, v, s, t) {
    const x = u - 2 * (s - 2), y = v - 2 * (t - 2), isNear = x >= 18 && x < 30 && y >= 10 && y < 22;
    return isNear ? [230, 60, x * 20 % 256] : [u * 5 % 256, v * 7 % 256, (u >> 2) + (v >> 2) & 1 ? 128 : 60];
}

function makeTextures() {
    const quick = ['--spp', '1', '--effort', '0', '-q'];
    tessera('bake', 'composed', '-o', inFolder('sphere.tess'), '--size', '64x32x16x16', '--layers', ...quick);
    tessera('bake', 'composed', '-o', inFolder('inside.tess'), '--proxy', 'sphere-inside:0,1.1,0,0.4', '--size',
            '64x32x8x8', ...quick);
    const mesh = ['bake', 'composed', '--proxy', 'mesh', '--density', '6', '--directions', '8x8', ...quick];
    tessera(...mesh, '--single', '-o', inFolder('mesh.tess'));
    tessera(...mesh, '--layered', '-o', inFolder('layered.tess'));
    writeFileSync(inFolder('box.gltf'), bumpyBox());
    tessera('bake', inFolder('box.gltf'), '-o', inFolder('lit.tess'), '--layered', '--texels', '20000', '--lights', '8',
            '--spp', '1', '--quality', '100', '-q');
    writeFileSync(inFolder('panes.gltf'), bumpyBox(0.6));
    tessera('bake', inFolder('panes.gltf'), '-o', inFolder('panes.tess'), '--layered', '--texels', '6000', '--lights', '4',
            '--spp', '1', '--quality', '100', '-q');
    fitBox(tessera, inFolder, 'box.gltf', 'fitted.tess');
    for (const [name, colour, ...more] of [['planar', planarColour, '0'],
                                           ['aligned', movingColour, '2', '--tile', '16x16x3x5']]) {
        writeFileSync(inFolder(`${name}.rgb`), texelsOf([48, 36, 5, 5], colour));
        tessera('encode', inFolder(`${name}.rgb`), '--size', '48x36x5x5', '--angular-map', 'planar-views', '-o',
                inFolder(`${name}.tess`), '-q', '--effort', ...more);
    }
}

const options = pose => ['eye', 'look', 'fov', 'focus', 'rays']
                            .map(name => [`--${name}`, pose[name]])
                            .flatMap(([name, value]) => value === undefined ? [] : [`${name}=${value}`]);
function rendered(name, pose, size = '200x150') {
    execFileSync(renderer,
                 ['render', inFolder(name), '-o', inFolder('v.png'), '--pixels', size, '-q', ...options(pose)]);
    return readPng(readFileSync(inFolder('v.png')));
}
const hash = (pose, size = '200x150') =>
    `#size=${size}` + Object.entries(pose).map(([name, value]) => `&${name}=${value}`).join('');

function agrees(picture, png, what) {
    const {share, most, psnr} = compared(picture, png);
    console.log(`${what}: ${(100 * share).toFixed(3)} % within 1 of 255, at most ${most}, ${psnr.toFixed(1)} dB`);
    assert(share >= near, `${what}: only ${100 * share} % of the pixels agree`);
}
// True if the picture has more than 20 colours.
const hasContent = ({rgba}) => new Set(rgba.toString('latin1').match(/.{4}/gs)).size > 20;

const tests = {
    async 'standalone pages show what render draws'(browser) {
        const inside = {eye: '0.1,1.15,0.05', look: '1,0.3,1.2', fov: 80};
        // The mesh is drawn larger, because pixels at its edges, where rasterising and ray casting
        // differ, are a smaller share of a larger picture. It is seen aslant, because all pixels of an
        // upright edge differ if it is near a column of rays.
        for (const [name, size, ...poses] of [['sphere', '200x150', {}, {eye: '0.5,10,0.2'}],
                                              ['inside', '200x150', inside],
                                              ['layered', '400x300', {eye: '4,3,7'}],
                                              ['mesh', '400x300', {eye: '4,3,7'},
                                               {eye: '30,18,9', fov: 12, rays: 1}]]) {
            tessera('view', inFolder(`${name}.tess`), '-o', inFolder(`${name}.html`), '-q');
            for (const pose of poses) {
                await browser.open(`file://${inFolder(name)}.html${hash(pose, size)}`);
                agrees(await browser.picture(), rendered(`${name}.tess`, pose, size),
                       `${name} ${JSON.stringify(pose)}`);
            }
        }
    },

    // Sharp highlights exaggerate the rounding of positions and normals, so that the share of equal pixels is no measure.
    async 'photographs: differences by direction look as render draws them'(browser) {
        tessera('view', inFolder('fitted.tess'), '-o', inFolder('fitted.html'), '-q');
        for (const pose of [{}, {eye: '4,2,3'}]) {
            await browser.open(`file://${inFolder('fitted.html')}${hash(pose, '400x300')}`);
            const picture = await browser.picture(), {psnr} = compared(picture, rendered('fitted.tess', pose, '400x300'));
            console.log(`fitted ${JSON.stringify(pose)}: ${psnr.toFixed(1)} dB`);
            assert(hasContent(picture) && psnr > 35, `${psnr} dB`);
            assert.equal(await browser.evaluate('Object.keys(tessera.layers.loaded).length'), 2);
        }
    },
    // One pose is served in parts: tiles behind the panes must be loaded, too.
    async 'blended surfaces show what is behind them, as render draws it'(browser, {url}) {
        tessera('view', inFolder('panes.tess'), '-o', inFolder('panes.html'), '-q');
        for (const [i, pose] of [{eye: '6,4,5'}, {eye: '1.6,1.3,1.9', look: '0.4,0.2,0.9', fov: 30}].entries()) {
            const at = hash(pose, '400x300');
            await browser.open(i === 1 ? `${url}?f=panes.tess${at.replace('#', '#parts&')}`
                                       : `file://${inFolder('panes.html')}${at}`);
            const picture = await browser.picture(), {psnr} = compared(picture, rendered('panes.tess', pose, '400x300'));
            console.log(`panes ${JSON.stringify(pose)}: ${psnr.toFixed(1)} dB`);
            assert(hasContent(picture) && psnr > 40, `${psnr} dB`);
            assert(await browser.evaluate('tessera.renderer.blends'));
        }
    },
    async 'layers: what render draws, damage, and too little memory'(browser, {url}) {
        tessera('convert', inFolder('panes.tess'), inFolder('lit.tess'), '-o', inFolder('lit.glb'), '--picture-side', '32',
                '-q');
        tessera('view', inFolder('lit.glb#1'), '-o', inFolder('lit.html'), '-q');
        const views = [{eye: '6,4,5'}, {eye: '1.6,1.3,1.9', look: '0.4,0.2,0.9', fov: 30}, {eye: '-30,18,9', fov: 12}];
        for (const [i, pose] of views.entries()) {
            const at = hash(pose, '400x300');
            await browser.open(i === 1 ? `${url}?f=lit.glb&texture=1${at.replace('#', '#parts&')}`
                                       : `file://${inFolder('lit.html')}${at}`);
            const picture = await browser.picture();
            const {psnr} = compared(picture, rendered('lit.tess', pose, '400x300'));
            console.log(`layers ${JSON.stringify(pose)}: ${psnr.toFixed(1)} dB`);
            assert(hasContent(picture) && psnr > 40, `${psnr} dB`);
            assert.equal(await browser.evaluate('Object.keys(tessera.layers.loaded).length'), 6);
        }
        const page = readFileSync(inFolder('lit.html'), 'latin1'), file = readFileSync(inFolder('lit.tess'));
        const withFile = (name, bytes) => writeFileSync(
            inFolder(name), page.replace(/id="file">[^<]*/, `id="file">${bytes.toString('base64')}`), 'latin1');
        file[file.length - 20] ^= 1; // in the data of the last layer, environment
        withFile('damaged.html', file);
        await browser.open(`file://${inFolder('damaged.html')}${hash(views[0])}`);
        assert(hasContent(await browser.picture()));
        assert.match(await browser.note(), /^The environment layer cannot be shown: .*checksum/);
        await browser.open(`file://${inFolder('lit.html')}${hash(views[0]).replace('#', '#cache=0.3&')}`);
        assert(hasContent(await browser.picture()));
        assert.match(await browser.note(), /^The roughness layer cannot be shown: .* 314.6 kB of GPU memory/);
        file[file.indexOf('LAYR') + 4] ^= 1; // its checksum
        withFile('damaged.html', file);
        await browser.open(`file://${inFolder('damaged.html')}${hash(views[0])}`);
        await browser.until(`document.getElementById('note')?.classList.contains('error')`, 'a message');
        assert.match(await browser.note(), /checksum/);
    },

    async 'viewer and decoder stay within their size budget'() {
        const page = readFileSync(inFolder('sphere.html'), 'latin1');
        const own =
            page.replace(/<script type="text\/plain" id="(file|data)">[^<]*/g, '').replace(/base64,[^"]*/, '').length;
        console.log(`viewer and decoder: ${own} bytes of a page of ${page.length}`);
        assert(own < pageBudget, `${own} bytes`);
        assert(!/(src|href)="(?!data:)/.test(page), 'the page loads another resource');
    },

    async 'planar views: parallax, focus and aperture'(browser) {
        tessera('view', inFolder('planar.tess'), '-o', inFolder('planar.html'), '-q');
        await browser.open(`file://${inFolder('planar.html')}${hash({})}`, 200, 150);
        const middle = await browser.picture();
        // The middle camera draws each texel 25 / 6 pixels wide, so the texels of its view appear
        // at their positions.
        const texels = texelsOf([48, 36, 5, 5], planarColour);
        let wrong = 0;
        for (let v = 1; v < 35; ++v)
            for (let u = 1; u < 47; ++u) {
                const pixel = 4 * (Math.floor((v + 0.5) * 150 / 36) * 200 + Math.floor((u + 0.5) * 200 / 48));
                const texel = 3 * (((v * 48 + u) * 5 + 2) * 5 + 2);
                wrong += [0, 1, 2].some(c => Math.abs(middle.rgba[pixel + c] - texels[texel + c]) > 60);
            }
        assert(wrong < 0.1 * 34 * 46, `${wrong} texels are at wrong positions`);
        const pose = () => browser.evaluate('tessera.pose');
        await browser.drag([100, 75], [60, 75]);
        const moved = await browser.picture();
        assert(compared(moved, {...middle, channels: 4, pixels: middle.rgba}).share < 0.9,
               'dragging showed no parallax');
        if (spawnSync(renderer, ['render', inFolder('planar.tess'), '-o', inFolder('v.png'), '-q']).status === 5)
            console.log('        (this tool renders no planar views: not compared)');
        else {
            const far = {eye: '0.2,-0.1,2.5', look: '0.1,0.05,0', fov: 35, focus: 3};
            for (const [name, at, alignment] of [['planar', {eye: (await pose()).eye.join()}, [0, 0]],
                                                 ['planar', far, [0, 0]], ['aligned', far, [-2, 2]]]) {
                tessera('view', inFolder(`${name}.tess`), '-o', inFolder(`${name}.html`), '-q');
                await browser.open(`file://${inFolder(name)}.html${hash(at)}`, 200, 150);
                agrees(await browser.picture(), rendered(`${name}.tess`, at), `${name} views ${JSON.stringify(at)}`);
                assert.deepEqual(await browser.evaluate('tessera.info.alignment'), alignment);
            }
        }
        await browser.open(`file://${inFolder('planar.html')}${hash({})}`, 200, 150);
        await browser.picture();
        await browser.mouse('mouseWheel', 100, 75, {deltaX: 0, deltaY: 2000});
        await browser.mouse('mouseWheel', 100, 75, {deltaX: 0, deltaY: -400, modifiers: 8});
        const focused = await browser.picture(), {disparity, reach} = await pose();
        assert.equal(disparity.toFixed(3), '2.000');
        assert(reach > 1.5);
        assert(compared(focused, {...middle, channels: 4, pixels: middle.rgba}).share < 0.9,
               'focus and aperture did not change the picture');
    },

    async 'input: drag, wheel, keys, touch, reset'(browser) {
        await browser.open(`file://${inFolder('mesh.html')}${hash({rays: 1}, '400x300')}`, 400, 300);
        await browser.picture();
        await browser.drag([200, 150], [260, 170]);
        await browser.mouse('mouseWheel', 200, 150, {deltaX: 0, deltaY: -150});
        // The picture is read before the pose, because events may arrive late on a busy machine.
        const picture = await browser.picture();
        const {eye, look} = await browser.evaluate('tessera.pose');
        assert(Math.hypot(...eye) < 9 && Math.abs(eye[2]) > 2 && eye[1] > 0.5, `${eye}`);
        agrees(picture, rendered('mesh.tess', {eye: eye.join(), look: look.join(), rays: 1}, '400x300'),
               'mesh after drag and wheel');
        await browser.key('i');
        await browser.until(`document.getElementById('figures').textContent.includes('tiles')`, 'figures');
        await browser.key('ArrowLeft');
        assert.notDeepEqual(await browser.evaluate('tessera.pose.eye'), eye);
        const distance = () =>
            browser.evaluate('Math.hypot(...tessera.pose.eye.map((x, i) => x - tessera.pose.look[i]))');
        const before = await distance();
        await browser.fingers([[180, 150], [220, 150]], [[140, 150], [260, 150]]);
        assert(await distance() < 0.6 * before, 'spreading two fingers did not move the camera nearer');
        await browser.evaluate(`document.querySelector('[data-action=reset]').click()`);
        assert.deepEqual(await browser.evaluate('tessera.pose.eye'), [10, 0, 0]);
    },

    async 'high-density displays and resized windows'(browser) {
        await browser.open(`file://${inFolder('sphere.html')}`, 120, 90, 2);
        await browser.picture();
        assert.deepEqual(await browser.evaluate('[tessera.gl.canvas.width, tessera.gl.canvas.height]'), [240, 180]);
        await browser.resize(90, 120, 1);
        await browser.until('tessera.gl.canvas.width === 90 && tessera.gl.canvas.height === 120',
                            'the canvas follows the window');
        assert(hasContent(await browser.picture()));
    },

    async 'says why it cannot show a file'(browser) {
        const page = readFileSync(inFolder('sphere.html'), 'latin1');
        const file = readFileSync(inFolder('sphere.tess'));
        file[20] ^= 255; // in the header
        writeFileSync(inFolder('damaged.html'), page.replace(/id="file">[^<]*/, `id="file">${file.toString('base64')}`),
                      'latin1');
        await browser.open(`file://${inFolder('damaged.html')}`);
        await browser.until(`document.getElementById('note')?.classList.contains('error')`, 'a message');
        assert.match(await browser.note(), /header|damaged|checksum/i);
        await browser.open('about:blank');
        await browser.send('Page.addScriptToEvaluateOnNewDocument',
                           {source: 'HTMLCanvasElement.prototype.getContext = () => null'});
        await browser.send('Page.enable');
        await browser.send('Page.navigate', {url: `file://${inFolder('sphere.html')}`});
        await browser.until(`document.getElementById('note')?.classList.contains('error')`, 'a message');
        assert.match(await browser.note(), /WebGL2/);
    },

    async 'from a server: in parts, with lost requests, in a small cache'(browser, {url}) {
        const line = await badLine(url);
        try {
            await browser.open(`${line.url}?f=sphere.tess${hash({}).replace('#', '#parts&cache=1.6&')}`);
            agrees(await browser.picture(), rendered('sphere.tess', {}), 'sphere from a server');
            const {slots, tiles, first, coarse} =
                await browser.evaluate(`({slots: tessera.cache.slots, tiles: tessera.cache.grid.tiles,
                coarse: !!tessera.renderer.coarse, first: tessera.source.asked})`);
            assert(slots < tiles && coarse, `${slots} of ${tiles}`);
            assert(line.broken > 0 && first > line.broken, 'lost requests were not repeated');
            for (const pose of [{eye: '-10,0,0'}, {}]) { // there and back, so that tiles are replaced in the cache
                await browser.evaluate(`location.hash = '${hash(pose).replace('#', '#parts&cache=1.6&')}'`);
                await browser.until(`tessera.pose.eye.join() === '${pose.eye ?? '10,0,0'}'`, 'the hash is followed');
                agrees(await browser.picture(), rendered('sphere.tess', pose),
                       `sphere from a server ${JSON.stringify(pose)}`);
            }
        } finally {
            line.close();
        }
        await browser.open(`${url}?f=mesh.tess${hash({rays: 1}, '400x300')}`);
        agrees(await browser.picture(), rendered('mesh.tess', {rays: 1}, '400x300'), 'mesh from a server');
        assert(await browser.evaluate('tessera.source.asked') <= 2, 'a small file took more than two requests');
        await browser.open(`${url}?f=nothing.tess`);
        await browser.until(`document.getElementById('note')?.classList.contains('error')`, 'a message');
        assert.match(await browser.note(), /no such file/);
    },

    async 'view serves only its file'(browser) {
        const {url, stop} = await startServer('view', inFolder('sphere.tess'), '--no-open');
        try {
            assert(url.endsWith('?f=sphere.tess'), url);
            await browser.open(`${url}${hash({})}`);
            agrees(await browser.picture(), rendered('sphere.tess', {}), 'sphere from view');
            assert.equal((await fetch(url.replace(/\?.*/, 'mesh.tess'))).status, 404);
        } finally {
            stop();
        }
    },
};

// A proxy between browser and server that cuts off every third range request.
async function badLine(server) {
    const line = {broken: 0};
    let parts = 0;
    const proxy = createServer(async (request, response) => {
        if (request.headers.range && ++parts % 3 === 2) {
            ++line.broken;
            return request.socket.destroy();
        }
        const {range} = request.headers;
        const answer = await fetch(server.replace(/\/$/, '') + request.url,
                                   {headers: {'accept-encoding': 'identity', ...(range && {range})}});
        const ofConnection = /^(connection|keep-alive|transfer-encoding)$/;
        const headers = [...answer.headers].filter(([name]) => !ofConnection.test(name));
        response.writeHead(answer.status, Object.fromEntries(headers));
        response.end(Buffer.from(await answer.arrayBuffer()));
    });
    await new Promise(ready => proxy.listen(0, '127.0.0.1', ready));
    line.url = `http://127.0.0.1:${proxy.address().port}/`;
    line.close = () => {
        proxy.closeAllConnections();
        proxy.close();
    };
    return line;
}

async function startServer(...verb) {
    const process = spawn(tool, verb, {stdio: ['ignore', 'pipe', 'inherit']});
    const line = await new Promise((resolve, reject) => {
        process.stdout.once('data', data => resolve(String(data).trim()));
        process.once('exit', code => reject(Error(`tessera ${verb[0]} ended (${code})`)));
    });
    return {url: line, stop: () => process.kill('SIGTERM')};
}

async function main() {
    if (spawnSync(program, ['--version']).error) {
        console.log(`SKIPPED: there is no ${program} here; Debian's package is chromium`);
        return 77;
    }
    makeTextures();
    const tried = spawnSync(tool, ['view', inFolder('sphere.tess'), '-o', inFolder('sphere.html')]);
    if (tried.status === 5) {
        console.log(`SKIPPED: ${tried.stderr}`);
        return 77;
    }
    const server = await startServer('serve', folder, '--port', '0', '--quiet'), browser = new Browser(program);
    let failed = 0;
    try {
        for (const [name, test] of Object.entries(tests).filter(([name]) => name.includes(only))) {
            const begin = Date.now();
            try {
                await test(browser, server);
                console.log(`ok      ${name}, ${((Date.now() - begin) / 1000).toFixed(1)} s`);
            } catch (error) {
                ++failed;
                console.log(`FAILED  ${name}: ${error.stack}`);
                writeFileSync(join(tmpdir(), 'viewer_test_failed.png'), await browser.screenshot().catch(() => ''));
            }
        }
    } finally {
        await browser.close();
        server.stop();
    }
    return failed ? 1 : 0;
}

let code = 1;
try {
    code = await main();
} finally {
    rmSync(folder, {recursive: true, force: true});
}
process.exit(code);
