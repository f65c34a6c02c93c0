// Reports which tiles coarse levels replaced because a file is partial or damaged.
#pragma once

#include "codec/decoder.h"
#include "tools/support/json_text.h"

#include <string>

namespace tessera {

// Lines that begin with `indent` and end with a line break. Empty if no tile that was read is
// missing or damaged. Lists at most eight damaged tiles with their texels.
std::string fill_text(const Decoder& decoder, const std::string& indent);

// `status` of opening a file; if only its beginning is there, with a hint to --allow-partial.
Status with_partial_hint(const Status& status, ByteSource& file, const DecodeOptions& options);

// {"received_bytes", "file_bytes", "missing_tiles", "damaged_tiles", "filled_texels", "damaged":
// [...]}
Json fill_json(const Decoder& decoder);

} // namespace tessera
