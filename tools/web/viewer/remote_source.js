// A file on a web server, read in parts. Parts that several workers want at about the same time come by few
// requests, what was read last stays, and a lost connection is tried again until it is back.

class RemoteSource {
    static block = 4096;      // bytes that are asked for and kept together
    static gap = 4;           // blocks between two parts that cost less than a request
    static requests = 6;      // at a time
    static patience = 20e3;   // milliseconds without an answer, or without a byte more of it

    // onTrouble(text) hears what goes wrong, and '' when it goes right again.
    constructor(url, onTrouble) {
        Object.assign(this, {url, onTrouble, size: 0, received: 0, asked: 0});
        this.blocks = new Map();   // number -> Uint8Array, what was used last at the end
        this.most = 1 << 16;       // blocks that are kept: 256 MiB
        this.coming = new Map();   // number -> Promise
        this.wanted = new Set();
        this.waiting = [];         // {b, resolve, reject} of wanted
        this.running = 0;
        this.turns = [];           // of requests that wait for one that runs to end
    }

    // Learns size and version with the first bytes.
    async open() {
        const first = await this.request(0, RemoteSource.block * 2 - 1);
        this.store(0, first);
        return this;
    }

    async read(offset, length) {
        const {block} = RemoteSource, first = Math.floor(offset / block), last = Math.floor((offset + length - 1) / block);
        const missing = () => Array.from({length: last - first + 1}, (_, i) => first + i).filter(b => !this.blocks.has(b));
        for (let wanted = missing(); wanted.length; wanted = missing()) // other reads may push out what was there
            await Promise.all(wanted.map(b => this.arrival(b)));
        const out = new Uint8Array(length);
        for (let b = first; b <= last; ++b) {
            const bytes = this.blocks.get(b), begin = b * block - offset;
            this.keep(b, bytes);
            out.set(bytes.subarray(Math.max(0, -begin), Math.max(0, Math.min(block, length - begin))), Math.max(0, begin));
        }
        return out;
    }

    arrival(b) {
        if (!this.coming.has(b)) {
            if (!this.wanted.size)
                setTimeout(() => this.ask(), 3); // what others want in the meantime goes along
            this.wanted.add(b);
            this.coming.set(b, new Promise((resolve, reject) => this.waiting.push({b, resolve, reject})));
        }
        return this.coming.get(b);
    }

    // Turns wanted blocks into requests.
    ask() {
        const blocks = [...this.wanted].sort((a, b) => a - b);
        this.wanted.clear();
        const waiting = this.waiting;
        this.waiting = [];
        for (let i = 0; i < blocks.length;) {
            let j = i;
            while (j + 1 < blocks.length && blocks[j + 1] - blocks[j] <= RemoteSource.gap && blocks[j + 1] - blocks[i] < 1024)
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
                this.keep(first + at / block, bytes.slice(at, at + block)); // alone: the rest may go
    }

    keep(b, bytes) {
        this.blocks.delete(b);
        this.blocks.set(b, bytes);
        if (this.blocks.size > this.most)
            this.blocks.delete(this.blocks.keys().next().value);
    }

    // Bytes from..to, both included, however long it takes. Errors: what trying again does not mend.
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
                // fetch() does not tell one from the other.
                const forbidden = error.lost && !this.size && attempt > 1 &&
                    ', or that server does not let pages of other sites read its files (CORS; tessera serve does)';
                this.onTrouble(`${error.message}${forbidden || ''}; trying again`);
                await pause(Math.min(8000, 250 * 2 ** attempt) * (0.75 + Math.random() / 2));
            }
        }
    }

    // At most so many at a time.
    async turn(work) {
        if (this.running < RemoteSource.requests)
            ++this.running;
        else
            await new Promise(go => this.turns.push(go));
        try {
            return await work();
        } finally {
            if (this.turns.length)
                this.turns.shift()(); // who gets the place of this one
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
            const answer = await fetch(this.url, {headers: {Range: `bytes=${from}-${to}`}, cache: 'no-store', signal: cut.signal});
            if (answer.status === 429 || answer.status >= 500)
                throw passing(`the server answers ${answer.status}`);
            if (answer.status !== 206 && answer.status !== 200)
                throw Error(answer.status === 404 ? 'there is no such file on the server' : `the server answers ${answer.status}`);
            this.checkVersion(answer);
            const bytes = await this.body(answer, heard);
            return answer.status === 206 ? this.part(answer, from, to, bytes) : this.whole(from, to, bytes);
        } catch (error) {
            // fetch() says TypeError where there is no connection.
            const lost = error.name === 'TypeError' || error.name === 'AbortError';
            throw lost ? Object.assign(passing('the connection is lost'), {lost}) : error;
        } finally {
            clearTimeout(timer);
        }
    }

    // However long a slow line takes for it.
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

    // A file that is replaced meanwhile must not be mixed with what was read before.
    checkVersion(answer) {
        const version = `${answer.headers.get('ETag')} ${answer.headers.get('Last-Modified')}`;
        if (this.version !== undefined && version !== this.version)
            throw Error('the file on the server has changed: load the page again');
        this.version = version;
    }

    part(answer, from, to, bytes) {
        const said = /^bytes (\d+)-(\d+)\/(\d+)$/.exec(answer.headers.get('Content-Range') || '');
        if (!this.size && !said)
            throw Error('the server does not say how long the file is (Content-Range)');
        if (said && this.size && +said[3] !== this.size)
            throw Error('the file on the server has changed: load the page again');
        this.size = this.size || +said[3];
        if ((said && +said[1] !== from) || bytes.length !== Math.min(to + 1, this.size) - from)
            throw passing('the server sent another part than was asked for');
        return bytes;
    }

    // A server without ranges sends all there is.
    whole(from, to, bytes) {
        this.size = bytes.length;
        this.most = Infinity; // each request would bring all of it again
        this.store(0, bytes);
        return bytes.subarray(from, to + 1);
    }
}

const pause = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));

// An error that may be gone the next time.
function passing(text) {
    return Object.assign(Error(text), {passing: true});
}
