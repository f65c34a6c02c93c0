// The command lines of picture codecs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tessera {

struct PictureTool {
    const char* id;
    const char* about;
    std::vector<std::string> tools; // encoder, decoder; one entry if it is both
    const char* package;
    std::vector<std::string> version;
    std::uint32_t max_side;
    const char* ending;
    const char* pictures; // its uncompressed format; ppm is the fastest
    std::vector<std::string> settings, coarser, finer;
    std::vector<std::string> (*encode)(const std::string& in, const std::string& out,
                                       const std::string& setting, const std::string& threads);
    std::vector<std::string> (*decode)(const std::string& in, const std::string& out,
                                       const std::string& threads);
};

const PictureTool& avif_tool();
const PictureTool& avif_planes_tool();
const PictureTool& jxl_tool();
const PictureTool& astc_tool();

} // namespace tessera
