// The workers that decode, and their work in the order in which it is wanted.

class Workers {
    static jobsAhead = 2; // of one worker: the next travels while one is decoded

    // source: RemoteSource, or null where `bytes` are the whole file.
    constructor(kit, source, bytes) {
        const code = ['tessera.js', 'slot_layout.js', 'tile_worker.js'].map(name => kit.text(name).replace(/^export /gm, '')).join('\n');
        this.address = URL.createObjectURL(new Blob([code, '\nstartTileWorker();'], {type: 'text/javascript'}));
        Object.assign(this, {kit, source, bytes, answers: new Map(), lastJob: 0});
        this.workers = [this.start()];
    }

    start() {
        const worker = {thread: new Worker(this.address), busy: 0};
        worker.thread.onmessage = ({data}) => data.read ? this.read(worker, data) : this.answered(worker, data);
        worker.thread.onerror = event => this.broken(event.message || 'a worker could not start');
        return worker;
    }

    // Opens the file; then more workers open it, too. Returns what the file says about itself.
    async open() {
        const size = this.source && this.source.size;
        const open = worker => this.job(worker, {job: 'open', wasm: this.kit.bytes('tessera.wasm'), bytes: this.bytes, size});
        const {info} = await open(this.workers[0]);
        const more = clamp((navigator.hardwareConcurrency || 2) - 1, 1, 4) - 1;
        for (let i = 0; i < more; ++i)
            this.workers.push(this.start());
        // As many as there is memory for.
        this.opened = Promise.all(this.workers.slice(1).map(worker => open(worker).catch(() => this.drop(worker))));
        return info;
    }

    // Told to all of them.
    async prepare(job) {
        await this.opened;
        await Promise.all(this.workers.map(worker => this.job(worker, {job: 'prepare', ...job})));
    }

    get idle() {
        return this.workers.reduce((sum, w) => sum + Math.max(0, Workers.jobsAhead - w.busy), 0);
    }

    // No more jobs for it; what it was given it answers.
    drop(worker) {
        if (this.workers.length > 1)
            this.workers = this.workers.filter(w => w !== worker);
    }

    // By the worker with the least to do. An error `elsewhere`: its file is gone, others may do the same job.
    run(job) {
        return this.job(this.workers.reduce((best, w) => w.busy < best.busy ? w : best), job);
    }

    job(worker, job) {
        ++worker.busy;
        return new Promise((resolve, reject) => {
            this.answers.set(++this.lastJob, {resolve, reject});
            worker.thread.postMessage({id: this.lastJob, ...job});
        });
    }

    answered(worker, data) {
        --worker.busy;
        const {resolve, reject} = this.answers.get(data.id);
        this.answers.delete(data.id);
        if (data.gone)
            this.drop(worker);
        if (data.error)
            reject(Object.assign(Error(data.error), {elsewhere: data.gone && !this.workers.includes(worker)}));
        else
            resolve(data);
    }

    broken(text) {
        this.answers.forEach(({reject}) => reject(Error(text)));
        this.answers.clear();
        this.workers.forEach(worker => worker.busy = 0);
    }

    async read(worker, {read, offset, length}) {
        try {
            const bytes = await this.source.read(offset, length);
            worker.thread.postMessage({bytesOf: read, bytes}, [bytes.buffer]);
        } catch (error) {
            worker.thread.postMessage({bytesOf: read, error: error.message});
        }
    }
}
