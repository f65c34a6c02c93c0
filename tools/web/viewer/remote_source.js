// A file on a web server that is read in parts. Parts that several workers need at about the same time are fetched with
// few requests. The most recently used parts are cached, and lost connections are retried until they work again.

class RemoteSource {
    static block = 4096;      // bytes; the unit of requests and of the cache
    static gap = 4;           // parts at most this many blocks apart share a request
    static requests = 6;      // simultaneous requests
    static patience = 20e3;   // milliseconds without a response or further bytes of it until a request is cancelled

    // onTrouble(text) is called with a message when a request fails, and with '' when requests work again.
    constructor(url, onTrouble) {
        Object.assign(this, {url, onTrouble, size: 0, received: 0, asked: 0});
        this.blocks = new Map();   // number -> Uint8Array, the most recently used at the end
        this.most = 1 << 16;       // number of cached blocks: 256 MiB
        this.coming = new Map();   // number -> Promise
        this.wanted = new Set();   // numbers that the next ask() requests
        this.waiting = [];         // {b, resolve, reject} for each wanted block
        this.running = 0;
        this.turns = [];           // starts of requests that wait until another one ends
    }

    // Fetches the first bytes and, with them, the size and the version of the file.
    async open() {
        const first = await this.request(0, RemoteSource.block * 2 - 1);
        this.store(0, first);
        return this;
    }

    async read(offset, length) {
        const {block} = RemoteSource;
        const first = Math.floor(offset / block), last = Math.floor((offset + length - 1) / block);
        const missing = () =>
            Array.from({length: last - first + 1}, (_, i) => first + i).filter(b => !this.blocks.has(b));
        for (let wanted = missing(); wanted.length; wanted = missing()) // other reads may have evicted blocks
            await Promise.all(wanted.map(b => this.arrival(b)));
        const out = new Uint8Array(length);
        for (let b = first; b <= last; ++b) {
            const bytes = this.blocks.get(b), begin = b * block - offset;
            this.keep(b, bytes);
            out.set(bytes.subarray(Math.max(0, -begin), Math.max(0, Math.min(block, length - begin))),
                    Math.max(0, begin));
        }
        return out;
    }

    arrival(b) {
        if (!this.coming.has(b)) {
            if (!this.wanted.size)
                setTimeout(() => this.ask(), 3); // the delay lets requests of other workers join
            this.wanted.add(b);
            this.coming.set(b, new Promise((resolve, reject) => this.waiting.push({b, resolve, reject})));
        }
        return this.coming.get(b);
    }

    // Merges wanted blocks into requests.
    ask() {
        const blocks = [...this.wanted].sort((a, b) => a - b);
        this.wanted.clear();
        const waiting = this.waiting;
        this.waiting = [];
        for (let i = 0; i < blocks.length;) {
            let j = i;
            while (j + 1 < blocks.length && blocks[j + 1] - blocks[j] <= RemoteSource.gap &&
                   blocks[j + 1] - blocks[i] < 1024)
                ++j;
            this.bring(blocks[i], blocks[j], waiting.filter(w => w.b >= blocks[i] && w.b <= blocks[j]));
            i = j + 1;
        }
    }

    async bring(first, last, waiting) {
        const {block} = RemoteSource;
        try {
            this.store(first, await this.request(first * block, Math.min((last + 1) * block, this.size) - 1));
            waiting.forEach(w => w.resolve());
        } catch (error) {
            waiting.forEach(w => w.reject(error));
        }
        for (let b = first; b <= last; ++b)
            this.coming.delete(b);
    }

    store(first, bytes) {
        const {block} = RemoteSource;
        for (let at = 0; at < bytes.length; at += block)
            if (at + block <= bytes.length || first * block + bytes.length === this.size)
                this.keep(first + at / block, bytes.slice(at, at + block)); // a copy, so that the rest can be freed
    }

    keep(b, bytes) {
        this.blocks.delete(b);
        this.blocks.set(b, bytes);
        if (this.blocks.size > this.most)
            this.blocks.delete(this.blocks.keys().next().value);
    }

    // Fetches the bytes from..to, both included, and repeats failed attempts forever. Throws only the errors that
    // another attempt cannot fix.
    async request(from, to) {
        for (let attempt = 0;; ++attempt) {
            try {
                const bytes = await this.turn(() => this.attempt(from, to));
                if (attempt)
                    this.onTrouble('');
                return bytes;
            } catch (error) {
                if (!error.passing)
                    throw error;
                // fetch() reports both cases with the same error.
                const forbidden = error.lost && !this.size && attempt > 1 &&
                    ', or the server does not allow other sites to read its files (CORS; tessera serve allows it)';
                this.onTrouble(`${error.message}${forbidden || ''}; retrying`);
                await pause(Math.min(8000, 250 * 2 ** attempt) * (0.75 + Math.random() / 2));
            }
        }
    }

    // Runs `work` once fewer than RemoteSource.requests are running.
    async turn(work) {
        if (this.running < RemoteSource.requests)
            ++this.running;
        else
            await new Promise(go => this.turns.push(go));
        try {
            return await work();
        } finally {
            if (this.turns.length)
                this.turns.shift()(); // a waiting request replaces this one
            else
                --this.running;
        }
    }

    async attempt(from, to) {
        const cut = new AbortController();
        let timer;
        const heard = () => {
            clearTimeout(timer);
            timer = setTimeout(() => cut.abort(), RemoteSource.patience);
        };
        heard();
        ++this.asked;
        try {
            const answer =
                await fetch(this.url, {headers: {Range: `bytes=${from}-${to}`}, cache: 'no-store', signal: cut.signal});
            if (answer.status === 429 || answer.status >= 500)
                throw passing(`the server responded with status ${answer.status}`);
            if (answer.status !== 206 && answer.status !== 200)
                throw Error(answer.status === 404 ? 'there is no such file on the server'
                                                  : `the server responded with status ${answer.status}`);
            this.checkVersion(answer);
            const bytes = await this.body(answer, heard);
            return answer.status === 206 ? this.part(answer, from, to, bytes) : this.whole(from, to, bytes);
        } catch (error) {
            // fetch() throws TypeError if there is no connection.
            const lost = error.name === 'TypeError' || error.name === 'AbortError';
            throw lost ? Object.assign(passing('the connection was lost'), {lost}) : error;
        } finally {
            clearTimeout(timer);
        }
    }

    // Reads the body. A slow connection may take any time, as long as bytes arrive.
    async body(answer, heard) {
        const parts = [];
        for (const reader = answer.body.getReader();;) {
            const {done, value} = await reader.read();
            if (done)
                return new Uint8Array(await new Blob(parts).arrayBuffer());
            heard();
            this.received += value.length;
            parts.push(value);
        }
    }

    // Parts of different versions of a file must not be mixed.
    checkVersion(answer) {
        const version = `${answer.headers.get('ETag')} ${answer.headers.get('Last-Modified')}`;
        if (this.version !== undefined && version !== this.version)
            throw Error('the file on the server has changed: reload the page');
        this.version = version;
    }

    part(answer, from, to, bytes) {
        const said = /^bytes (\d+)-(\d+)\/(\d+)$/.exec(answer.headers.get('Content-Range') || '');
        if (!this.size && !said)
            throw Error('the server does not send the size of the file (Content-Range)');
        if (said && this.size && +said[3] !== this.size)
            throw Error('the file on the server has changed: reload the page');
        this.size = this.size || +said[3];
        if ((said && +said[1] !== from) || bytes.length !== Math.min(to + 1, this.size) - from)
            throw passing('the server sent another part of the file than the requested one');
        return bytes;
    }

    // A server without range requests sends the whole file.
    whole(from, to, bytes) {
        this.size = bytes.length;
        this.most = Infinity; // evicted blocks would cost another request for the whole file
        this.store(0, bytes);
        return bytes.subarray(from, to + 1);
    }
}

const pause = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));

// An error that another attempt may not meet.
function passing(text) {
    return Object.assign(Error(text), {passing: true});
}
