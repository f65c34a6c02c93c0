// Tests the viewer with WebGPU in Chromium, whose device is SwiftShader, a GPU on the CPU. It must draw the same pixels
// as with WebAssembly alone, and go on without WebGPU when the device is missing, too small or lost.
//   node webgpu_test.mjs TESSERA CHROMIUM
// Exit codes: 0 all tests pass, 1 a test fails, 77 there is no WebGPU here.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {Browser} from './browser.mjs';

const [tool, program] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'tessera-webgpu-'));
const compiling = 240; // seconds for SwiftShader to compile the shaders on a busy machine
// The cache holds a part of the tiles, so that the other side of the sphere replaces them.
const hash = (pose, more = '&webgpu') => `#size=200x150&parts&cache=1.6&eye=${pose}${more}`;
const front = '10,0,0', back = '-10,0,0';

async function startServer() {
    const server = spawn(tool, ['serve', folder, '--port', '0', '--quiet'], {stdio: ['ignore', 'pipe', 'inherit']});
    const url = await new Promise((resolve, reject) => {
        server.stdout.once('data', data => resolve(String(data).trim()));
        server.once('exit', code => reject(Error(`tessera serve ended (${code})`)));
    });
    return {page: `${url}?f=sphere.tess`, stop: () => server.kill('SIGTERM')};
}

const gpu = browser => browser.evaluate('tessera.gpu ?? null');
async function turned(browser, pose) {
    await browser.evaluate(`location.hash = '${hash(pose)}'`);
    await browser.until(`tessera.pose.eye.join() === '${pose}'`, 'the hash is followed');
    return browser.picture();
}
function same(picture, expected, what) {
    // The place of a tile in the cache changes the last bit of what the texture unit interpolates.
    const most = picture.rgba.reduce((most, sample, i) => Math.max(most, Math.abs(sample - expected.rgba[i])), 0);
    assert(most <= 1, `${what}: ${most} of 255 off`);
    console.log(`ok      ${what}`);
}

// Opens the page with `code` in front of the code of the worker that uses WebGPU.
async function openWith(browser, url, code) {
    await browser.open('about:blank');
    await browser.send('Page.enable');
    await browser.send('Page.addScriptToEvaluateOnNewDocument', {source: `
        const Plain = Blob;
        window.Blob = class extends Plain {
            constructor(parts, options) {
                const isWorker = parts.some(part => typeof part === 'string' && part.includes('loadOnGpu('));
                super(isWorker ? [${JSON.stringify(code)}, ...parts] : parts, options);
            }
        };`});
    await browser.send('Page.navigate', {url});
}
async function fails(browser, message) {
    await browser.until('!!window.tessera?.gpu?.failed', 'the worker gives up', compiling);
    const {failed, joined} = await gpu(browser);
    assert.match(failed, message);
    assert(!joined);
}

async function run(browser, page) {
    await browser.open(page + hash(front, ''));
    const pictures = {[front]: await browser.picture()};
    pictures[back] = await turned(browser, back);
    assert.equal(await browser.evaluate('!!navigator.gpu'), true);
    assert.equal(await gpu(browser), null, 'a device on the CPU is used unasked');

    await openWith(browser, page + hash(front), `
        const small = {get: () => 16384};
        Object.defineProperty(GPUSupportedLimits.prototype, 'maxComputeWorkgroupStorageSize', small);\n`);
    await fails(browser, /no WebGPU/);
    same(await browser.picture(), pictures[front], 'a device that is too small');

    await openWith(browser, page + hash(front), `
        const request = GPUAdapter.prototype.requestDevice;
        GPUAdapter.prototype.requestDevice = async function (wanted) {
            const device = await request.call(this, wanted);
            device.destroy();
            return device;
        };\n`);
    await fails(browser, /./);
    same(await browser.picture(), pictures[front], 'a device that is lost at once');

    // The device is lost after some tiles.
    await openWith(browser, page + hash(front), `
        let submits = 0, device;
        const request = GPUAdapter.prototype.requestDevice, submit = GPUQueue.prototype.submit;
        GPUAdapter.prototype.requestDevice = async function (wanted) {
            return device = await request.call(this, wanted);
        };
        GPUQueue.prototype.submit = function (work) {
            if (++submits > 12)
                device.destroy();
            return submit.call(this, work);
        };\n`);
    same(await browser.picture(), pictures[front], 'while shaders are compiled');
    await browser.until('!!tessera.gpu?.joined || !!tessera.gpu?.failed', 'the worker joins', compiling);
    assert((await gpu(browser)).joined, JSON.stringify(await gpu(browser)));
    await browser.evaluate('tessera.workers.workers = tessera.workers.workers.slice(-1)');
    same(await turned(browser, back), pictures[back], 'tiles that the GPU decodes');
    const {tiles, failed} = await gpu(browser);
    assert(tiles > 2 && !failed, `${tiles} tiles, ${failed}`);
    for (let turn = 0; turn < 8 && !(await gpu(browser)).failed; ++turn)
        same(await turned(browser, turn % 2 ? back : front), pictures[turn % 2 ? back : front], `turn ${turn}`);
    assert.match((await gpu(browser)).failed, /./, 'the device was not lost');
    same(await turned(browser, front), pictures[front], 'a device that is lost while it decodes');
}

async function main() {
    execFileSync(tool, ['bake', 'composed', '-o', join(folder, 'sphere.tess'), '--size', '64x32x16x16', '--layers',
                        '--spp', '1', '--effort', '0', '-q']);
    const browser = new Browser(program, ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader']);
    const server = await startServer();
    try {
        await browser.open(server.page);
        if (!await browser.evaluate('navigator.gpu?.requestAdapter().then(adapter => !!adapter)')) {
            console.log('SKIPPED: this Chromium has no WebGPU on SwiftShader');
            return 77;
        }
        await run(browser, server.page);
        return 0;
    } finally {
        await browser.close();
        server.stop();
    }
}

let code = 1;
try {
    code = await main();
} catch (error) {
    console.log(`FAILED  ${error.stack}`);
} finally {
    rmSync(folder, {recursive: true, force: true});
}
process.exit(code);
