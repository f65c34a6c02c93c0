// Translates SPIR-V to WGSL by the build of Tint that Babylon.js ships as WebAssembly.
//   node tint.cjs NODE_MODULES FOLDER      writes FOLDER/NAME.wgsl for each FOLDER/NAME.spv
const fs = require("fs");
const path = require("path");

const [modules, folder] = process.argv.slice(2);
const assets = path.join(modules, "@babylonjs/core/assets/twgsl");

// twgsl.js expects a browser's script tag or CommonJS without a package around it.
function loadTint() {
    const file = path.join(assets, "twgsl.js");
    const module = {exports: {}};
    new Function("module", "exports", "require", "__dirname", "__filename", fs.readFileSync(file, "utf8"))(
        module, module.exports, require, assets, file);
    return module.exports(path.join(assets, "twgsl.wasm"));
}

// Tint reports errors on the console and returns what it has.
function translated(tint, words) {
    const messages = [];
    const kept = {log: console.log, warn: console.warn, error: console.error};
    for (const name in kept)
        console[name] = (...parts) => messages.push(parts.join(" "));
    try {
        const text = tint.convertSpirV2WGSL(words, false);
        if (messages.length || !text)
            throw new Error(messages.join("\n") || "Tint gives no reason");
        return text;
    } finally {
        Object.assign(console, kept);
    }
}

loadTint().then(tint => {
    for (const name of fs.readdirSync(folder).filter(name => name.endsWith(".spv"))) {
        const bytes = fs.readFileSync(path.join(folder, name));
        const words = new Uint32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
        try {
            fs.writeFileSync(path.join(folder, name.replace(".spv", ".wgsl")), translated(tint, words));
        } catch (error) {
            console.error(`${name}: ${error.message}`);
            process.exitCode = 1;
        }
    }
});
