// The workers that decode, and their jobs.

class Workers {
    static jobsAhead = 2; // jobs per worker: one that is decoded, and one that is ready when it ends

    // source: {size, read(offset, length)}, or null if `bytes` is the whole file.
    constructor(kit, source, bytes) {
        const code = ['tessera.js', 'slot_layout.js', 'tile_worker.js']
                         .map(name => kit.text(name).replace(/^export /gm, ''))
                         .join('\n');
        this.address = URL.createObjectURL(new Blob([code, '\nstartTileWorker();'], {type: 'text/javascript'}));
        Object.assign(this, {kit, source, bytes, answers: new Map(), lastJob: 0});
        this.workers = [this.start()];
    }

    start(address = this.address) {
        const worker = {thread: new Worker(address), busy: 0};
        worker.thread.onmessage = ({data}) => data.read ? this.read(worker, data) : this.answered(worker, data);
        worker.thread.onerror = event => this.broken(event.message || 'a worker failed to start');
        return worker;
    }

    // Opens the file in one worker, then in more of them. Returns the Info of the file and its layers, as
    // tile_worker.js has them.
    async open() {
        const size = this.source && this.source.size;
        const open = worker =>
            this.job(worker, {job: 'open', wasm: this.kit.bytes('tessera.wasm'), bytes: this.bytes, size});
        const opened = await open(this.workers[0]);
        const more = clamp((navigator.hardwareConcurrency || 2) - 1, 1, 4) - 1;
        for (let i = 0; i < more; ++i)
            this.workers.push(this.start());
        // Workers for which there is no memory are dropped.
        this.opened = Promise.all(this.workers.slice(1).map(worker => open(worker).catch(() => this.drop(worker))));
        return opened;
    }

    // Sends a job of type "prepare" to all workers.
    async prepare(job) {
        this.prepared = {job: 'prepare', ...job};
        await this.opened;
        await Promise.all(this.workers.map(worker => this.job(worker, this.prepared)));
    }

    get idle() {
        return this.workers.reduce((sum, w) => sum + Math.max(0, Workers.jobsAhead - w.busy), 0);
    }

    // Stops giving jobs to a worker, which still completes the ones it has.
    drop(worker) {
        if (this.workers.length > 1)
            this.workers = this.workers.filter(w => w !== worker);
    }

    // Gives a job to the least busy worker. An error with `elsewhere` means that this worker has lost its file, and
    // that another one may do the job.
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
