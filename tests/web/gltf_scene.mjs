// Draws .glb files in headless Chromium with the loaders of three.js and Babylon.js (gltf_page.html).
import fs from 'node:fs';
import {createServer} from 'node:http';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {Browser} from './browser.mjs';
import {pngOf} from './png.mjs';

const page = path.join(path.dirname(fileURLToPath(import.meta.url)), 'gltf_page.html');
const types = {'.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm'};

// What Babylon.js loads as a script: three.js' module without its export.
function meshoptScript(npm) {
    const module = path.join(npm, 'three/examples/jsm/libs/meshopt_decoder.module.js');
    return fs.readFileSync(module, 'utf8').replace(/^export .*$/m, '');
}

// roots: the folders {package, npm, files} that are served under these names, with byte ranges.
function serve(roots) {
    return createServer((request, response) => {
        const [, root, ...rest] = decodeURIComponent(new URL(request.url, 'http://x').pathname).split('/');
        if (rest.join('/') === 'meshopt_decoder.js')
            return response.writeHead(200, {'Content-Type': 'text/javascript'}).end(meshoptScript(roots.npm));
        const file = root === '' ? page : path.join(roots[root] ?? roots.files, ...rest);
        if (!fs.existsSync(file) || !fs.statSync(file).isFile())
            return response.writeHead(404).end();
        const bytes = fs.readFileSync(file);
        const headers = {'Content-Type': types[path.extname(file)] ?? 'application/octet-stream'};
        const range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
        if (!range)
            return response.writeHead(200, headers).end(bytes);
        const part = bytes.subarray(+range[1], +range[2] + 1);
        headers['Content-Range'] = `bytes ${range[1]}-${+range[1] + part.length - 1}/${bytes.length}`;
        response.writeHead(206, headers).end(part);
    });
}

export class GltfScene {
    static async open(chromium, roots) {
        const scene = new GltfScene();
        scene.server = serve(roots);
        await new Promise(ready => scene.server.listen(0, '127.0.0.1', ready));
        scene.browser = new Browser(chromium, ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader']);
        await scene.browser.open(`http://127.0.0.1:${scene.server.address().port}/`);
        await scene.browser.until('!!window.draw', 'the page loads', 60);
        return scene;
    }

    // engine: 'three' or 'babylon'; name: a file in `files`; plugin: whether ours is used; view: {eye, look, fov, far,
    // background: 8-bit numbers, size}. Resolves to what gltf_page.html gives, and {picture: {width, height, rgba}, png}.
    async draw(engine, name, plugin, {background = [0, 0, 0], ...view}) {
        const scene = JSON.stringify({...view, background: background.map(x => x / 255)});
        const shown = await this.run(`draw('${engine}', '/files/${name}', ${plugin}, ${scene})`);
        const [width, height] = shown.size, upside = Buffer.from(shown.rgba, 'base64'), rgba = Buffer.alloc(upside.length);
        for (let y = 0; y < height; ++y)
            upside.copy(rgba, y * width * 4, (height - 1 - y) * width * 4, (height - y) * width * 4);
        const png = pngOf(width, height, (x, y) => rgba.subarray(4 * (y * width + x), 4 * (y * width + x) + 3));
        return {...shown, picture: {width, height, rgba}, png};
    }
    run(code) {
        return this.browser.evaluate(code);
    }
    get said() {
        return this.browser.said.join('\n');
    }
    async close() {
        await this.browser.close();
        this.server.close();
    }
}
