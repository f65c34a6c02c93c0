// What was shown from coarse levels because the file is a part or damaged, for people and programs.
#pragma once

#include "codec/decoder.h"
#include "tools/support/json_text.h"

#include <string>

namespace tessera {

// Lines that begin with `indent`, each with its end; empty where every tile that was read is there.
// At most eight damaged tiles are named with their texels.
std::string fill_text(const Decoder& decoder, const std::string& indent);

// An error of opening a file of which only the beginning is there, with the option that takes that.
Status with_partial_hint(const Status& status, ByteSource& file, const DecodeOptions& options);

// {"received_bytes", "file_bytes", "missing_tiles", "damaged_tiles", "filled_texels", "damaged": [...]}
Json fill_json(const Decoder& decoder);

} // namespace tessera
