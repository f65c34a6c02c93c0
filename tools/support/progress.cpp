#include "tools/support/progress.h"

#include "tools/support/parse.h"
#include "tools/support/system.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <utility>

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double first_after = 0.3, again_after = 0.1; // seconds; short work shows nothing
constexpr int bar_width = 30;

double seconds(Clock::duration d) {
    return std::chrono::duration<double>(d).count();
}

std::string time_left(double elapsed, double fraction) {
    if (fraction < 0.01 || elapsed < 1)
        return "";
    const int left = static_cast<int>(std::min(elapsed / fraction - elapsed, 359999.0));
    char text[32];
    if (left >= 3600)
        std::snprintf(text, sizeof text, "%d:%02d h left", left / 3600, left / 60 % 60);
    else
        std::snprintf(text, sizeof text, "%d:%02d min left", left / 60, left % 60);
    return text;
}

std::atomic<int> shown{0}; // visible Progress objects

} // namespace

void show_waiting(std::optional<std::uint64_t> bytes) {
    static Clock::time_point start = Clock::time_point::max(), last;
    static bool drawn = false;
    static std::mutex mutex; // each connection to a server calls this from its own thread
    const std::lock_guard lock(mutex);
    const auto now = Clock::now();
    if (!bytes) {
        if (std::exchange(drawn, false) && shown == 0)
            std::fputs("\r\x1b[K", stderr);
        start = Clock::time_point::max();
        return;
    }
    start = std::min(start, now);
    if (shown > 0 || seconds(now - start) < 1 || seconds(now - last) < again_after ||
        !is_terminal(StandardStream::error))
        return;
    last = now;
    drawn = true;
    std::fprintf(stderr, "\rtessera: waiting for the server, %.0f s, %s received\x1b[K",
                 seconds(now - start), human_bytes(*bytes).c_str());
    std::fflush(stderr);
}

Progress::Progress(std::string title, bool quiet)
    : title_(std::move(title)), visible_(!quiet && is_terminal(StandardStream::error)),
      stage_start_(Clock::now()), last_(stage_start_) {
    shown += visible_;
}

Progress::~Progress() {
    shown -= visible_;
    if (drawn_)
        std::fputs("\r\x1b[K", stderr);
}

ProgressFunction Progress::function() {
    if (!visible_)
        return {};
    return [this](const char* stage, double done, double total) { show(stage, done, total); };
}

void Progress::show(const char* stage, double done, double total) {
    const auto now = Clock::now();
    if (stage_ != stage) {
        stage_ = stage;
        stage_start_ = now;
    }
    if (seconds(now - last_) < (drawn_ ? again_after : first_after))
        return;
    last_ = now;
    drawn_ = true;
    const double fraction = total > 0 ? std::clamp(done / total, 0.0, 1.0) : 0;
    std::string bar(static_cast<std::size_t>(bar_width), '.');
    std::fill_n(bar.begin(), static_cast<int>(fraction * bar_width), '#');
    std::fprintf(stderr, "\r%s: %s [%s] %3d%%  %s\x1b[K", title_.c_str(), stage, bar.c_str(),
                 static_cast<int>(fraction * 100),
                 time_left(seconds(now - stage_start_), fraction).c_str());
    std::fflush(stderr);
}

} // namespace tessera
