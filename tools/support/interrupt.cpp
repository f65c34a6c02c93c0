#include "tools/support/interrupt.h"

#include <csignal>
#include <ctime>
#include <unistd.h>

namespace tessera {
namespace {

volatile std::sig_atomic_t received = 0;
volatile std::time_t received_at = 0;

// A second signal means impatience, but not within the same moment: timeout(1) and shells may
// deliver one Ctrl-C twice.
void remember(int signal) {
    const std::time_t now = std::time(nullptr);
    if (received && now > received_at + 1)
        _exit(128 + signal);
    if (!received)
        received_at = now;
    received = signal;
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
    struct sigaction action = {};
    action.sa_handler = remember;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART; // reads and writes go on; the next box stops
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    action.sa_handler = SIG_IGN;
    sigaction(SIGXFSZ, &action, nullptr);
    sigaction(SIGPIPE, &action, nullptr);
}

int interrupted_by() {
    return received;
}

Status check_interrupt() {
    return received ? Status(ErrorCode::runtime, "interrupted") : Status();
}

std::unique_ptr<TexelSource> interruptible(std::unique_ptr<TexelSource> inner) {
    return std::make_unique<InterruptibleSource>(std::move(inner));
}

std::unique_ptr<TexelSink> interruptible(std::unique_ptr<TexelSink> inner) {
    return std::make_unique<InterruptibleSink>(std::move(inner));
}

} // namespace tessera
