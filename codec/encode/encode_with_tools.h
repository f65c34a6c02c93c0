// The encoder with coding tools switched by hand, for studies and tests.
#pragma once

#include "codec/encoder.h"
#include "codec/tile_encoder/tool_switches.h"

namespace tessera {

// As the function of encoder.h. Precondition: no options.reuse.
Result<EncodeReport> encode_memory(TexelSource& source, std::vector<std::byte>& out,
                                   const EncodeOptions& options, const ToolSwitches& tools);

} // namespace tessera
