// Drives a headless Chromium through its pipe (DevTools protocol), without packages.
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

export class Browser {
    // flags: further arguments of Chromium.
    constructor(program, flags = []) {
        this.folder = mkdtempSync(join(tmpdir(), 'tessera-web-'));
        this.process = spawn(program, ['--headless=new', '--no-sandbox', '--remote-debugging-pipe', '--no-first-run',
            '--disable-extensions', '--hide-scrollbars', `--user-data-dir=${this.folder}`, ...flags, 'about:blank'],
            {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
        this.answers = new Map();
        this.lastId = 0;
        this.said = [];
        let rest = Buffer.alloc(0);
        this.process.stdio[4].on('data', data => {
            rest = Buffer.concat([rest, data]);
            for (let end; (end = rest.indexOf(0)) >= 0; rest = rest.subarray(end + 1))
                this.hear(JSON.parse(rest.subarray(0, end)));
        });
        this.process.stdio[3].on('error', () => {});
        this.gone =
            new Promise((_, reject) => this.process.on('exit', code => reject(Error(`Chromium ended (${code})`))));
        this.gone.catch(() => {});
    }

    hear(message) {
        if (message.method === 'Runtime.consoleAPICalled')
            this.said.push(message.params.args.map(a => a.value ?? a.description).join(' '));
        if (message.method === 'Runtime.exceptionThrown')
            this.said.push(message.params.exceptionDetails.exception?.description ??
                           message.params.exceptionDetails.text);
        const answer = this.answers.get(message.id);
        if (!answer)
            return;
        this.answers.delete(message.id);
        message.error ? answer.reject(Error(message.error.message)) : answer.resolve(message.result);
    }

    // sessionId null addresses the browser instead of the tab.
    send(method, params = {}, sessionId = this.session) {
        const id = ++this.lastId;
        const answer = new Promise((resolve, reject) => this.answers.set(id, {resolve, reject}));
        this.process.stdio[3].write(JSON.stringify({id, method, params, sessionId: sessionId ?? undefined}) + '\0');
        return Promise.race([answer, this.gone]);
    }

    // Opens a new tab and closes the previous one.
    async open(url, width = 640, height = 480, ratio = 1) {
        const old = this.target;
        this.target = (await this.send('Target.createTarget', {url: 'about:blank'}, null)).targetId;
        this.session =
            (await this.send('Target.attachToTarget', {targetId: this.target, flatten: true}, null)).sessionId;
        if (old)
            await this.send('Target.closeTarget', {targetId: old}, null);
        this.said = [];
        await this.send('Runtime.enable');
        await this.resize(width, height, ratio);
        await this.send('Page.navigate', {url});
    }
    resize(width, height, ratio = 1) {
        return this.send('Emulation.setDeviceMetricsOverride',
                         {width, height, deviceScaleFactor: ratio, mobile: false});
    }

    // Evaluates an expression in the page and awaits promises.
    async evaluate(expression) {
        const {result, exceptionDetails} =
            await this.send('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
        if (exceptionDetails)
            throw Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        return result.value;
    }
    async until(condition, what, seconds = 20) {
        for (const end = Date.now() + seconds * 1000; Date.now() < end;) {
            if (await this.evaluate(condition))
                return;
            await new Promise(wake => setTimeout(wake, 25));
        }
        throw Error(`${what}: not within ${seconds} s; the page shows: ${await this.note()}; ` +
                    `console: ${this.said.join(' | ')}`);
    }
    note() {
        return this.evaluate(`document.getElementById('note')?.textContent`);
    }

    // The viewer's final picture, after all tiles have arrived: {width, height, rgba}, rows from
    // the top.
    async picture() {
        await this.until('!!(window.tessera && tessera.loader)', 'the viewer starts');
        const [width, height, text] = await this.evaluate(`(async () => {
            await tessera.settled();
            const gl = tessera.gl, {width, height} = gl.canvas, bytes = new Uint8Array(width * height * 4);
            gl.bindFramebuffer(gl.FRAMEBUFFER, null);
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
            let text = '';
            for (let i = 0; i < bytes.length; i += 32768)
                text += String.fromCharCode(...bytes.subarray(i, i + 32768));
            return [width, height, btoa(text)];
        })()`);
        const upside = Buffer.from(text, 'base64'), rgba = Buffer.alloc(upside.length), row = width * 4;
        for (let y = 0; y < height; ++y)
            upside.copy(rgba, y * row, (height - 1 - y) * row, (height - y) * row);
        return {width, height, rgba};
    }
    async screenshot() {
        return Buffer.from((await this.send('Page.captureScreenshot', {format: 'png'})).data, 'base64');
    }
    mouse(type, x, y, more = {}) {
        return this.send('Input.dispatchMouseEvent', {type, x, y, button: 'left', clickCount: 1, ...more});
    }
    async drag(from, to) {
        await this.mouse('mousePressed', ...from, {buttons: 1});
        for (const part of [0.25, 0.5, 0.75, 1])
            await this.mouse('mouseMoved', from[0] + (to[0] - from[0]) * part, from[1] + (to[1] - from[1]) * part,
                             {buttons: 1});
        await this.mouse('mouseReleased', ...to);
    }
    // Moves touching fingers from the positions `from` to the positions `to`.
    async fingers(from, to) {
        const points = places => places.map(([x, y], id) => ({x, y, id}));
        await this.send('Input.dispatchTouchEvent', {type: 'touchStart', touchPoints: points(from)});
        for (const part of [0.5, 1])
            await this.send('Input.dispatchTouchEvent', {type: 'touchMove', touchPoints: points(
                from.map(([x, y], i) => [x + (to[i][0] - x) * part, y + (to[i][1] - y) * part]))});
        await this.send('Input.dispatchTouchEvent', {type: 'touchEnd', touchPoints: []});
    }
    key(key) {
        return this.send('Input.dispatchKeyEvent', {type: 'keyDown', key, text: key.length === 1 ? key : undefined})
            .then(() => this.send('Input.dispatchKeyEvent', {type: 'keyUp', key}));
    }

    async close() {
        this.send('Browser.close', {}, null).catch(() => {});
        const late = setTimeout(() => this.process.kill('SIGKILL'), 5000);
        await this.gone.catch(() => {});
        clearTimeout(late);
        rmSync(this.folder, {recursive: true, force: true, maxRetries: 5, retryDelay: 100});
    }
}
