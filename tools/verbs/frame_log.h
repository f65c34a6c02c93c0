// What `tessera render` says and writes of the frames of a view while it draws it.
#pragma once

#include "tools/view/view_renderer.h"

#include <functional>
#include <string>
#include <vector>

namespace tessera {

// "v-2.png" -> "v-2-truth.png".
std::string beside(const std::string& output, const std::string& what);

// Stores, writes and prints each frame of a view, at once, because the next may take a while.
class FrameLog {
public:
    // `log`: print; `write`: write a picture of each frame; `remote`: reads are requests.
    FrameLog(bool log, bool write, bool remote, SampleType type)
        : log_(log), write_(write), remote_(remote), type_(type) {}

    // `view`: its number, from 1.
    void begin(std::size_t view, const std::string& output);
    // The frames of the view. `traffic`: all that was read for it.
    std::vector<DrawnFrame> end(const Traffic& traffic);
    // Errors: those of picture() and write_view().
    Status add(unsigned number, const DrawnFrame& frame,
               const std::function<Result<View>()>& picture);

private:
    const bool log_, write_, remote_;
    const SampleType type_;
    std::size_t view_ = 0;
    std::string output_;
    std::vector<DrawnFrame> frames_; // of the view
};

} // namespace tessera
