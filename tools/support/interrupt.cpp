#include "tools/support/interrupt.h"

#include "format/output_file.h"
#include "tools/support/system.h"

#include <atomic>
#include <chrono>
#include <ctime>
#include <string>
#include <thread>

namespace tessera {
namespace {

// Any thread may run the signal handler, and all threads read these.
std::atomic<int> received{0};
std::atomic<std::time_t> received_at{0};
static_assert(std::atomic<int>::is_always_lock_free &&
              std::atomic<std::time_t>::is_always_lock_free);

// Time for a command to end by itself. Calls that cannot be interrupted (a library that decodes a
// large picture, a file system that does not respond) take longer.
constexpr std::chrono::milliseconds longest_end{700};

// Ends the process if its regular end takes too long. The files that remain are the same.
void watch_for_signal() {
    wait_for_wake();
    std::this_thread::sleep_for(longest_end);
    std::string words = "tessera: error: interrupted";
    for (const std::string& journal : remove_unfinished_outputs())
        words += "; finished tiles are kept in " + journal +
                 "; the same command with --resume continues";
    words += "\n";
    write_standard_error(words);
    end_by_signal(received);
}

// A second signal ends the process, but not within a second: timeout(1) and shells may deliver one
// Ctrl-C twice.
void remember(int signal) {
    const std::time_t now = std::time(nullptr);
    if (received == 0)
        received_at = now; // before other threads can see the signal
    int none = 0;
    if (received.compare_exchange_strong(none, signal))
        wake_watcher();
    else if (now > received_at + 1)
        exit_at_once(128 + signal);
}

class InterruptibleSource : public TexelSource {
public:
    explicit InterruptibleSource(std::unique_ptr<TexelSource> inner) : inner_(std::move(inner)) {}
    const TextureDesc& desc() const override { return inner_->desc(); }
    Locality locality() const override { return inner_->locality(); }
    bool cheap_to_reread() const override { return inner_->cheap_to_reread(); }
    Status begin_slab(const Box4& box) override {
        TESSERA_TRY(check_interrupt());
        return inner_->begin_slab(box);
    }
    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_interrupt());
        return inner_->read(box, out);
    }

private:
    std::unique_ptr<TexelSource> inner_;
};

class InterruptibleSink : public TexelSink {
public:
    explicit InterruptibleSink(std::unique_ptr<TexelSink> inner) : inner_(std::move(inner)) {}
    Locality locality() const override { return inner_->locality(); }
    Status begin_slab(const Box4& box) override {
        TESSERA_TRY(check_interrupt());
        return inner_->begin_slab(box);
    }
    Status write(const Box4& box, std::span<const std::byte> texels) override {
        TESSERA_TRY(check_interrupt());
        return inner_->write(box, texels);
    }
    Status end_slab() override { return inner_->end_slab(); }
    Status finish() override {
        TESSERA_TRY(check_interrupt());
        return inner_->finish();
    }

private:
    std::unique_ptr<TexelSink> inner_;
};

} // namespace

void install_signal_handlers() {
    handle_interrupts(remember, watch_for_signal);
}

int interrupted_by() {
    return received;
}

Status check_interrupt() {
    return received != 0 ? Status(ErrorCode::runtime, "interrupted") : Status();
}

std::unique_ptr<TexelSource> interruptible(std::unique_ptr<TexelSource> inner) {
    return std::make_unique<InterruptibleSource>(std::move(inner));
}

std::unique_ptr<TexelSink> interruptible(std::unique_ptr<TexelSink> inner) {
    return std::make_unique<InterruptibleSink>(std::move(inner));
}

} // namespace tessera
