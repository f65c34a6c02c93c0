// Tessera as a codec that the sweep measures.
#pragma once

#include "tools/lab/rd/codec_under_test.h"

namespace tessera {

// Tessera at one effort. Settings look like "psnr 38" or "quality 62". The id is
// "tessera:<effort>".
CodecUnderTest tessera_codec(int effort, std::vector<std::string> settings);

} // namespace tessera
