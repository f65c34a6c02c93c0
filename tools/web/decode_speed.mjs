// Measures the size of the decoder for browsers and its speed beside the native decoder: the table of README.md.
//   node decode_speed.mjs PACKAGE-FOLDER TESSERA SCRATCH-FOLDER [OTHER.wasm ...]
// Speed is raw texels per second of CPU time on one core, the best of several runs. The decoders take turns, so that
// other work on the machine slows all of them alike. OTHER.wasm are builds with the same exports to compare with. Files
// that already exist in the scratch folder are used again.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import zlib from 'node:zlib';

const [folder, tool, scratch, ...others] = process.argv.slice(2);
const {loadTessera} = await import(pathToFileURL(path.resolve(folder, 'tessera.js')).href);
const runs = 8;
fs.mkdirSync(scratch, {recursive: true});

// Views of a camera grid: three layers of stripes at three depths.
function planarViews(U, V, S, T) {
    const out = Buffer.alloc(U * V * S * T * 3);
    let at = 0;
    for (let v = 0; v < V; ++v)
        for (let u = 0; u < U; ++u)
            for (let t = 0; t < T; ++t)
                for (let s = 0; s < S; ++s)
                    for (let c = 0; c < 3; ++c) {
                        const x = u - (c + 1) * 0.6 * (s - S / 2), y = v - (c + 1) * 0.6 * (t - T / 2);
                        out[at++] = 128 + 60 * Math.sin(x / (3 + c)) + 60 * Math.sin(y / (5 - c) + x / 40);
                    }
    return out;
}

const sphere = ['bake', 'composed', '--size', '128x64x16x16'];
const mesh = ['bake', 'composed', '--proxy', 'mesh', '--density', '4', '--directions', '16x16'];
const files = [
    ['sphere', file => [...sphere, '--quality', '40', '-o', file]],
    ['sphere, effort 4', file => [...sphere, '--quality', '40', '--effort', '4', '-o', file]],
    ['sphere, lossless', file => [...sphere, '--max-error', '0', '--effort', '1', '-o', file]],
    ['sphere, half float', file => ['bake', 'lamps', '--size', '64x32x16x16', '-o', file]],
    ['mesh', file => [...mesh, '--effort', '2', '-o', file]],
    ['planar-views', file => {
        const raw = path.join(scratch, 'views.rgb');
        fs.writeFileSync(raw, planarViews(96, 96, 9, 9));
        return ['encode', raw, '--size', '96x96x9x9', '--angular-map', 'planar-views', '--quality', '40', '-o', file];
    }],
];

function made([kind, words]) {
    const file = path.join(scratch, kind.replace(/\W+/g, '_') + '.tess');
    if (!fs.existsSync(file)) {
        const command = words(file);
        execFileSync(tool, [...command, ...(command[0] === 'bake' ? ['--spp', '4'] : []), '-q']);
    }
    return {kind, file, bytes: fs.readFileSync(file)};
}

function ownSeconds(work) {
    const begin = process.cpuUsage().user;
    work();
    return (process.cpuUsage().user - begin) / 1e6;
}

// The user time of a process, measured by the shell. One process is too short to measure.
function processSeconds(...words) {
    const quoted = words.map(word => `'${word}'`).join(' ');
    const times = 10, loop = `for i in {1..${times}}; do '${tool}' ${quoted} >/dev/null; done`;
    const seconds = execFileSync('bash', ['-c', `TIMEFORMAT=%U; { time ${loop}; } 2>&1`], {encoding: 'utf8'});
    return Number(seconds.trim()) / times;
}

const wasms = [path.join(folder, 'tessera.wasm'), ...others];
for (const file of wasms) {
    const bytes = fs.readFileSync(file);
    console.log(`${path.basename(file)}: ${bytes.length} bytes, ${zlib.gzipSync(bytes, {level: 9}).length} gzipped`);
}
const glue = fs.readFileSync(path.join(folder, 'tessera.js'));
console.log(`tessera.js: ${glue.length} bytes, ${zlib.gzipSync(glue, {level: 9}).length} gzipped\n`);
const codecs = await Promise.all(wasms.map(file => loadTessera(fs.readFileSync(file))));

const otherColumns = others.map(o => ` ${path.basename(o)}, RGBA |`).join('');
console.log(`| file | bytes | raw | RGBA, MB/s | texels, MB/s | native, MB/s |${otherColumns}`);
console.log(`|---|---|---|---|---|---|${others.map(() => '---|').join('')}`);
for (const {kind, file, bytes} of files.map(made)) {
    const opened = codecs.map(codec => codec.openBytes(bytes));
    const [U, V, S, T] = opened[0].info.size, raw = U * V * S * T * opened[0].info.texelBytes;
    const atlas = new Uint8Array(U * V * S * T * 4), texels = new Uint8Array(raw);
    const out = path.join(scratch, 'out.raw');
    const work = [
        () => ownSeconds(() => opened[0].atlas([0, U, 0, V], atlas)),
        () => ownSeconds(() => opened[0].box([0, U, 0, V, 0, S, 0, T], texels)),
        () => processSeconds('decode', file, '-o', out, '-q', '--threads', '1'),
        () => processSeconds('info', file),
        ...opened.slice(1).map(other => () => ownSeconds(() => other.atlas([0, U, 0, V], atlas)))];
    const best = work.map(() => Infinity);
    for (let run = 0; run < runs; ++run)
        work.forEach((one, i) => { best[i] = Math.min(best[i], one()); });
    const [rgba, samples, decode, start, ...ofOthers] = best; // `info` takes the time that the program needs to start
    const cells = [rgba, samples, decode - start, ...ofOthers].map(seconds => Math.round(raw / seconds / 1e6));
    console.log(`| ${kind} | ${bytes.length} | ${(raw / 1e6).toFixed(1)} MB | ${cells.join(' | ')} |`);
    opened.forEach(each => each.close());
}
