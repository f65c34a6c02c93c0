#include "tools/http/http_transfers.h"

#include "tools/http/http_attempt.h"
#include "tools/support/interrupt.h"

#include <algorithm>
#include <condition_variable>
#include <list>
#include <mutex>
#include <thread>

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

// The delay until an interrupt is noticed.
constexpr std::chrono::milliseconds longest_poll{100};
constexpr std::chrono::milliseconds idle_poll{60000}; // run() and the destructor wake it

// The requests of one call of run().
struct Batch {
    std::size_t left = 0;
    Status error; // the first
};

struct Job {
    HttpRequest request;
    Batch* batch = nullptr;
    unsigned failures = 0;
    Clock::time_point not_before;
    std::unique_ptr<HttpAttempt> attempt; // while it is in flight
};

} // namespace

class HttpTransfers::Worker {
public:
    Worker(CURLM* multi, std::string url, std::string name, const HttpOptions& options)
        : multi_(multi), url_(std::move(url)), name_(std::move(name)), options_(options) {
        options_.in_flight = std::clamp(options_.in_flight, 1u, 64u);
        curl_multi_setopt(multi_, CURLMOPT_MAXCONNECTS, static_cast<long>(options_.in_flight));
        curl_multi_setopt(multi_, CURLMOPT_MAX_TOTAL_CONNECTIONS,
                          static_cast<long>(options_.in_flight));
        thread_ = std::thread([this] { work(); });
    }

    ~Worker() {
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        curl_multi_wakeup(multi_);
        thread_.join();
        curl_multi_cleanup(multi_);
    }

    void set_fields(std::vector<std::string> fields) { fields_ = std::move(fields); }

    Status run(std::span<const HttpRequest> requests) {
        Batch batch;
        batch.left = requests.size();
        std::list<Job> jobs;
        for (const HttpRequest& request : requests)
            jobs.push_back({.request = request, .batch = &batch});
        std::unique_lock lock(mutex_);
        waiting_.splice(waiting_.end(), jobs);
        curl_multi_wakeup(multi_);
        ended_.wait(lock, [&] { return batch.left == 0; });
        return batch.error;
    }

    HttpStatistics statistics() const { return {requests_, bytes_, retries_}; }

private:
    void work() {
        for (;;) {
            {
                const std::lock_guard lock(mutex_);
                if (stopping_ && waiting_.empty() && active_.empty())
                    return;
                try {
                    step();
                } catch (const std::exception& e) { // bad_alloc above all
                    fail_all({ErrorCode::runtime, e.what()});
                }
            }
            // Waits without the lock, so that run() can add jobs.
            curl_multi_poll(multi_, nullptr, 0, poll_milliseconds(), nullptr);
        }
    }

    void step() {
        if (interrupted_by() != 0 && !(waiting_.empty() && active_.empty()))
            fail_all({ErrorCode::runtime, "interrupted"});
        if (options_.deadline && Clock::now() >= *options_.deadline)
            fail_all({ErrorCode::io, "the time limit for the network is over; " +
                                         std::to_string(bytes_) + " bytes were received"});
        drop_failed();
        start_some();
        int running = 0;
        curl_multi_perform(multi_, &running);
        int left = 0;
        while (const CURLMsg* message = curl_multi_info_read(multi_, &left))
            if (message->msg == CURLMSG_DONE)
                finish(message->easy_handle, message->data.result);
        drop_failed();
        start_some();
        report_waiting();
        const auto now = Clock::now();
        auto pause = active_.empty() && waiting_.empty() ? idle_poll : longest_poll;
        for (const Job& job : waiting_)
            if (active_.size() < options_.in_flight)
                pause = std::min(pause, std::max(std::chrono::milliseconds{1},
                                                 std::chrono::ceil<std::chrono::milliseconds>(
                                                     job.not_before - now)));
        poll_ = pause;
    }

    void report_waiting() {
        const bool waits = !(active_.empty() && waiting_.empty());
        if (options_.waiting && (waits || reported_))
            options_.waiting(waits ? std::optional<std::uint64_t>(bytes_) : std::nullopt);
        reported_ = waits;
    }

    int poll_milliseconds() const { return static_cast<int>(poll_.count()); }

    void start_some() {
        const auto now = Clock::now();
        for (auto job = waiting_.begin();
             job != waiting_.end() && active_.size() < options_.in_flight;) {
            const auto current = job++;
            if (current->not_before > now)
                continue;
            auto attempt = HttpAttempt::create(url_, fields_, options_, current->request, bytes_);
            active_.splice(active_.end(), waiting_, current);
            if (!attempt) {
                end(current, attempt.status());
                continue;
            }
            if (curl_multi_add_handle(multi_, (*attempt)->handle()) != CURLM_OK) {
                end(current, {ErrorCode::runtime, "libcurl cannot start a request"});
                continue;
            }
            current->attempt = std::move(*attempt);
            ++requests_;
        }
    }

    void finish(CURL* handle, CURLcode code) {
        const auto job = std::ranges::find_if(
            active_, [&](const Job& j) { return j.attempt && j.attempt->handle() == handle; });
        if (job == active_.end())
            return;
        HttpAttempt::Outcome outcome = job->attempt->finish(code);
        stop(*job);
        if (outcome.status.ok() || !outcome.is_temporary || !job->batch->error.ok())
            return end(job, outcome.status);
        if (++job->failures > options_.retries) {
            const std::string tries =
                options_.retries == 0 ? "" : " (" + std::to_string(job->failures) + " attempts)";
            return end(job, {outcome.status.code(), outcome.status.message() + tries});
        }
        ++retries_;
        const auto back_off = options_.back_off * (1 << std::min(job->failures - 1, 16u));
        job->not_before =
            Clock::now() + std::max<std::chrono::milliseconds>(back_off, outcome.retry_after);
        waiting_.splice(waiting_.begin(), active_, job);
    }

    void stop(Job& job) {
        if (job.attempt == nullptr)
            return;
        curl_multi_remove_handle(multi_, job.attempt->handle());
        job.attempt.reset();
    }

    // Removes the job from active_.
    void end(std::list<Job>::iterator job, const Status& status) {
        stop(*job);
        Batch& batch = *job->batch;
        active_.erase(job);
        if (batch.error.ok())
            batch.error = status.with_context(name_);
        if (--batch.left == 0)
            ended_.notify_all();
    }

    void fail_all(const Status& status) {
        active_.splice(active_.end(), waiting_);
        while (!active_.empty())
            end(active_.begin(), status);
    }

    // Ends the remaining jobs of batches that have failed.
    void drop_failed() {
        for (auto job = waiting_.begin(); job != waiting_.end();) {
            const auto current = job++;
            if (!current->batch->error.ok())
                active_.splice(active_.end(), waiting_, current);
        }
        for (auto job = active_.begin(); job != active_.end();) {
            const auto current = job++;
            if (!current->batch->error.ok())
                end(current, current->batch->error);
        }
    }

    CURLM* const multi_;
    const std::string url_, name_;
    HttpOptions options_;
    std::vector<std::string> fields_;
    std::atomic<std::uint64_t> requests_{0}, bytes_{0}, retries_{0};

    std::mutex mutex_; // of the members below; the thread holds it except while it waits
    std::condition_variable ended_;
    std::list<Job> waiting_, active_;
    bool stopping_ = false;
    bool reported_ = false;                     // that requests are in flight
    std::chrono::milliseconds poll_{idle_poll}; // used by the thread only
    std::thread thread_;
};

Result<std::unique_ptr<HttpTransfers>>
HttpTransfers::create(const std::string& url, const std::string& name, const HttpOptions& options) {
    static const CURLcode started = curl_global_init(CURL_GLOBAL_DEFAULT); // once per process
    CURLM* multi = started == CURLE_OK ? curl_multi_init() : nullptr;
    if (multi == nullptr)
        return Status(ErrorCode::runtime, name + ": libcurl does not start");
    return std::unique_ptr<HttpTransfers>(
        new HttpTransfers(std::make_unique<Worker>(multi, url, name, options)));
}

HttpTransfers::HttpTransfers(std::unique_ptr<Worker> worker) : worker_(std::move(worker)) {}
HttpTransfers::~HttpTransfers() = default;

void HttpTransfers::set_fields(std::vector<std::string> fields) {
    worker_->set_fields(std::move(fields));
}

Status HttpTransfers::run(std::span<const HttpRequest> requests) {
    return worker_->run(requests);
}

HttpStatistics HttpTransfers::statistics() const {
    return worker_->statistics();
}

} // namespace tessera
